#include "testdata/hidden/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/median.h"
#include "core/rotation.h"

namespace flextip::hidden {
namespace {

using Rng = std::mt19937_64;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kOtherAxis_rad = 0.2;  // of a further motion from the first one's axis

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

bool Chance(Rng& rng, double probability) { return Uniform(rng, 0.0, 1.0) < probability; }

Eigen::Vector3d Direction(Rng& rng) {
  const double z = Uniform(rng, -1.0, 1.0), angle = Uniform(rng, 0.0, kTurn);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// A direction turned by `angle_rad` from `axis`, to any side.
Eigen::Vector3d Beside(const Eigen::Vector3d& axis, double angle_rad, Rng& rng) {
  const double side = Uniform(rng, 0.0, kTurn);
  const Eigen::Vector3d across =
      NormalBasis(axis) * Eigen::Vector2d(std::cos(side), std::sin(side));
  return std::cos(angle_rad) * axis + std::sin(angle_rad) * across;
}

/// Wire or tube: EI = E pi (D^4 - d^4) / 64.
Instrument DrawInstrument(Rng& rng) {
  while (true) {
    Instrument shaft;
    shaft.length_m = Uniform(rng, 0.35, 0.6);
    const bool steel = Chance(rng, 0.5);
    const double modulus = steel ? 193e9 : 60e9, density = steel ? 7900.0 : 6450.0;
    const double outer = Uniform(rng, 0.002, 0.004);
    const double inner = Chance(rng, 0.4) ? outer * Uniform(rng, 0.5, 0.85) : 0.0;
    shaft.outer_diameter_m = outer;
    shaft.bending_stiffness_Nm2 =
        modulus * std::numbers::pi / 64.0 * (std::pow(outer, 4) - std::pow(inner, 4));
    if (Chance(rng, 0.3)) {
      shaft.mass_per_length_kg_m =
          density * std::numbers::pi / 4.0 * (outer * outer - inner * inner);
    }
    const double stiffness = shaft.bending_stiffness_Nm2;
    const double unit_force = stiffness / (shaft.length_m * shaft.length_m);
    if (stiffness > 0.1 && stiffness < 1.5 && unit_force < 4.0) return shaft;
  }
}

void DrawRoll(Rng& rng, HiddenScene& scene) {
  scene.roll_rad = Uniform(rng, -0.5 * kTurn, 0.5 * kTurn);
  scene.roll_swing_rad = Chance(rng, 0.4) ? Uniform(rng, 0.2, 1.2) : 0.0;
  scene.roll_frequency_hz = Uniform(rng, 0.03, 0.1);
  scene.roll_phase_rad = Uniform(rng, 0.0, kTurn);
}

MotionSetup DrawMotion(const SceneDraw& draw, const HiddenScene& scene, Rng& rng) {
  MotionSetup motion;
  const std::vector<MotionKind> kinds = Kinds(draw.family);
  const auto i = std::uniform_int_distribution<std::size_t>(0, kinds.size() - 1)(rng);
  motion.kind = draw.motion.value_or(kinds[i]);
  motion.length_m = scene.instrument.length_m;
  motion.p_RP = scene.p_RP;
  motion.axis = Beside(Eigen::Vector3d::UnitX(), Uniform(rng, 0.0, 0.5), rng);
  motion.depth_from = Uniform(rng, 0.40, 0.48);
  motion.depth_to = Uniform(rng, 0.62, 0.70);
  motion.angle_rad = Uniform(rng, 0.2, 0.35);
  motion.peak_speed_m_s = Uniform(rng, 0.06, 0.2);
  return motion;
}

std::vector<Eigen::Vector3d> StraightPoints(const HiddenScene& scene, double s_m) {
  const WristCourse motion = scene.Motion();
  std::vector<Eigen::Vector3d> points;
  for (double t = 0.0; t < scene.duration_s; t += 0.1) {
    points.push_back(motion.StraightPoint(t, s_m));
  }
  return points;
}

Eigen::Vector3d Mean(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// The height along `normal` below which `part` of the points lie.
double HeightQuantile(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& normal,
                      double part) {
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const Eigen::Vector3d& p : points) heights.push_back(normal.dot(p));
  return LowerQuantile(std::move(heights), part);
}

/// Stiffness such that the straight tip would feel `force_N` or more for a quarter of the time.
simulation::Tissue DrawTissue(const HiddenScene& scene, double force_N, Rng& rng) {
  const auto tips = StraightPoints(scene, scene.instrument.length_m);
  simulation::Tissue tissue;
  tissue.normal = Beside(-scene.motion_setup.axis, Uniform(rng, 0.5, 1.4), rng);
  const double surface = HeightQuantile(tips, tissue.normal, Uniform(rng, 0.7, 0.95));
  const Eigen::Vector3d mean = Mean(tips);
  tissue.p_surface = mean + (surface - tissue.normal.dot(mean)) * tissue.normal;
  tissue.stiffness_N_m = force_N / (surface - HeightQuantile(tips, tissue.normal, 0.25));
  tissue.p_anchor = tissue.p_surface;
  tissue.onset_m = Uniform(rng, 0.002, 0.005);
  if (Chance(rng, 0.5)) {
    double widest = 0.0;
    for (const Eigen::Vector3d& p : tips) {
      widest = std::max(widest, (p - mean).cross(tissue.normal).norm());
    }
    tissue.tangential_stiffness_N_m = Uniform(rng, 0.1, 0.5) * force_N / widest;
  }
  return tissue;
}

LoadCourse DrawLoad(const SceneDraw& draw, const HiddenScene& scene, Rng& rng) {
  LoadCourse load;
  const double choice = Uniform(rng, 0.0, 1.0);
  load.kind = draw.load.value_or(choice < 0.05   ? LoadKind::kNone
                                 : choice < 0.30 ? LoadKind::kHungMass
                                 : choice < 0.60 ? LoadKind::kTissue
                                                 : LoadKind::kVarying);
  const double force_N = std::min(2.0, Uniform(rng, 0.6, 1.5) * scene.UnitForce());
  if (load.kind == LoadKind::kHungMass) load.mean_N = force_N * scene.gravity_m_s2.normalized();
  if (load.kind == LoadKind::kTissue) load.tissue = DrawTissue(scene, force_N, rng);
  if (load.kind == LoadKind::kVarying) {
    load.mean_N = 0.4 * force_N * Direction(rng);
    for (int i = 0; i < 4; ++i) {  // with the mean they may add up to the force
      load.amplitudes_N.emplace_back(0.15 * force_N * Direction(rng));
      load.frequencies_hz.push_back(0.03 + 0.06 * i + Uniform(rng, 0.0, 0.05));
      load.phases_rad.push_back(Uniform(rng, 0.0, kTurn));
    }
  }
  return load;
}

/// A camera at `distance_m` from `p_target`, looking at it from the port's side.
Pose DrawCameraPose(const Eigen::Vector3d& p_target, const Eigen::Vector3d& axis, double distance_m,
                    Rng& rng) {
  const Eigen::Vector3d forward = Beside(axis, Uniform(rng, 0.5, 1.3), rng);
  const double roll = Uniform(rng, 0.0, kTurn);
  const Eigen::Vector3d right =
      NormalBasis(forward) * Eigen::Vector2d(std::cos(roll), std::sin(roll));
  Pose T_RC;
  T_RC.R << right, forward.cross(right), forward;
  const double down = Uniform(rng, -0.01, 0.01), across = Uniform(rng, -0.01, 0.01);
  const Eigen::Vector3d aside(across, down, 0.0);
  T_RC.p = p_target - distance_m * forward + T_RC.R * aside;
  return T_RC;
}

bool InView(const CameraCalibration& camera, const std::vector<Eigen::Vector3d>& points) {
  constexpr double kMargin_px = 30.0;
  const Pose T_CR = camera.T_RC.Inverse();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d x = T_CR * p;
    if (x.z() < 0.06) return false;
    const double u = camera.cu_px + camera.fu_px * x.x() / x.z();
    const double v = camera.cv_px + camera.fv_px * x.y() / x.z();
    if (u < kMargin_px || u > camera.width_px - kMargin_px) return false;
    if (v < kMargin_px || v > camera.height_px - kMargin_px) return false;
  }
  return true;
}

CameraCalibration DrawCamera(const HiddenScene& scene, Rng& rng) {
  CameraCalibration camera;
  camera.width_px = 1280, camera.height_px = 720;
  camera.fu_px = camera.fv_px = std::round(Uniform(rng, 700.0, 950.0));
  camera.cu_px = 640.0, camera.cv_px = 360.0;
  camera.rate_hz = 25.0;
  const auto tips = StraightPoints(scene, scene.instrument.length_m);
  double farthest = 0.3;
  for (int attempt = 1; attempt <= 1000; ++attempt) {
    camera.T_RC =
        DrawCameraPose(Mean(tips), scene.motion_setup.axis, Uniform(rng, 0.15, farthest), rng);
    if (InView(camera, tips)) break;
    if (attempt % 100 == 0) farthest += 0.05;
  }
  return camera;
}

simulation::SensorSetup DrawSensors(const HiddenScene& scene, Rng& rng) {
  const auto about = [&](double sd) { return sd * std::exp(Uniform(rng, -0.2, 0.2)); };
  const double length = scene.instrument.length_m;
  simulation::SensorSetup sensors;
  sensors.wrist = WristStream{"wrist", 50.0, about(5e-5), about(3e-4), {}};
  sensors.em0.emplace();
  sensors.em0->comment = "em tip";
  sensors.em0->rate_hz = 50.0;
  sensors.em0->distance_from_tip_m = 0.02;
  sensors.em0->position_noise_m = about(1.3e-4);
  sensors.em0->orientation_noise_rad = about(5.6e-4);
  sensors.strain = StrainStream{"gages", 50.0, {0.2 * length, 0.833 * length}, about(8e-4), {}};
  sensors.load = LoadStream{"load cell", 50.0, about(5e-3), {}};
  sensors.tip.emplace();
  sensors.tip->comment = "tracked tip";
  sensors.tip->rate_hz = 25.0;
  sensors.tip->across_noise_m = about(8.5e-5);
  sensors.tip->depth_noise_m = about(2.9e-4);
  sensors.tip->direction_noise_rad = about(3e-3);
  sensors.tip->T_RC = scene.camera.T_RC;
  sensors.tip->line_of_sight = scene.camera.T_RC.R.col(2);
  return sensors;
}

}  // namespace

const char* Name(LoadKind kind) {
  constexpr const char* kNames[kLoadKinds] = {"none", "hung_mass", "tissue", "varying"};
  return kNames[static_cast<int>(kind)];
}

simulation::TipLoad LoadCourse::At(double t_s) const {
  simulation::TipLoad load{mean_N, tissue};
  for (std::size_t i = 0; i < amplitudes_N.size(); ++i) {
    load.constant_N += std::sin(kTurn * frequencies_hz[i] * t_s + phases_rad[i]) * amplitudes_N[i];
  }
  return load;
}

double HiddenScene::RollAt(double t_s) const {
  return roll_rad + roll_swing_rad * std::sin(kTurn * roll_frequency_hz * t_s + roll_phase_rad);
}

HiddenScene DrawScene(const SceneDraw& draw, Rng& rng) {
  // A generator for each part: what one part draws does not move the others.
  Rng parts[6];
  for (Rng& part : parts) part.seed(rng());
  HiddenScene scene;
  scene.duration_s = draw.duration_s;
  scene.instrument = DrawInstrument(parts[0]);
  Rng& place = parts[1];
  for (double& x : scene.p_RP) x = Uniform(place, -0.02, 0.02);
  if (Chance(place, 0.25)) scene.gravity_m_s2 = 9.81 * Direction(place);
  DrawRoll(place, scene);
  scene.motion_setup = DrawMotion(draw, scene, parts[2]);
  scene.motion_seed = parts[2]();
  scene.load = DrawLoad(draw, scene, parts[3]);
  scene.camera = DrawCamera(scene, parts[4]);
  scene.sensors = DrawSensors(scene, parts[5]);
  return scene;
}

HiddenScene WithOtherMotion(const HiddenScene& scene, const SceneDraw& draw, Rng& rng) {
  HiddenScene other = scene;
  DrawRoll(rng, other);
  other.motion_setup = DrawMotion(draw, other, rng);
  other.motion_setup.axis = Beside(scene.motion_setup.axis, Uniform(rng, 0.0, kOtherAxis_rad), rng);
  other.motion_seed = rng();
  other.load = DrawLoad(draw, other, rng);
  return other;
}

void AddShaftForm(const std::string& form, const HiddenScene& scene, Rng& rng,
                  simulation::PlantEffects& effects) {
  const MotionSetup& motion = scene.motion_setup;
  const double length = scene.instrument.length_m, unit_force = scene.UnitForce();
  if (form == "port_grip") {
    // What lies in the port runs from (1 - depth_to) L to (1 - depth_from) L.
    const double from = (1.0 - motion.depth_to) * length, to = (1.0 - motion.depth_from) * length;
    const double middle = from + Uniform(rng, 0.4, 0.6) * (to - from);
    const double half = 0.5 * Uniform(rng, 0.3, 0.5) * (to - from);
    effects.port_friction.grip_from_m = middle - half;
    effects.port_friction.grip_to_m = middle + half;
    effects.port_friction.grip_force_N = Uniform(rng, 1.0, 2.0) * unit_force;
  } else if (form == "taper") {
    effects.taper = (Chance(rng, 0.5) ? 1.0 : -1.0) * Uniform(rng, 0.25, 0.5);
  } else if (form == "shaft_tissue") {
    effects.shaft_tissue.time_constant_s = Uniform(rng, 0.5, 2.5);
    // Parts of the shaft move some 5 cm: this part of EI / L^2 in all over half its length.
    effects.shaft_tissue.stiffness_N_m2 =
        Uniform(rng, 0.15, 0.5) * unit_force / (0.05 * 0.5 * length);
  } else if (form == "second_contact") {
    simulation::SecondContact& contact = effects.second_contact;
    contact.s_from_tip_m = Uniform(rng, 0.1, 0.25) * length;
    contact.normal = Beside(motion.axis, Uniform(rng, 1.3, 1.7), rng);
    const auto points = StraightPoints(scene, length - contact.s_from_tip_m);
    const double surface = HeightQuantile(points, contact.normal, Uniform(rng, 0.35, 0.5));
    contact.p_surface = surface * contact.normal;
    contact.stiffness_N_m = Uniform(rng, 1.0, 2.0) * unit_force /
                            (surface - HeightQuantile(points, contact.normal, 0.0));
  }
}

}  // namespace flextip::hidden
