#include "testdata/hidden/forms.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flextip::hidden {
namespace {

using Rng = std::mt19937_64;
constexpr double kTurn = 2.0 * std::numbers::pi;

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

Eigen::Vector3d Direction(Rng& rng) {
  const double z = Uniform(rng, -1.0, 1.0), angle = Uniform(rng, 0.0, kTurn);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

double Seconds(TimeNs t_ns, const Recording& recording) {
  return 1e-9 * static_cast<double>(t_ns - recording.wrist0->samples.front().t_ns);
}

/// A triangle between -1 and 1, of period 1.
double Triangle(double x) { return 4.0 * std::abs(x - std::floor(x + 0.5)) - 1.0; }

/// A tooth that slips: from 0 to 1 within 80 ms.
double Slip(double t_s) {
  const double x = std::clamp(t_s / 0.08, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

/// Bouc and Wen's restoring part, between about -1 and 1, from readings one after the other.
class BoucWen {
 public:
  double Next(double x) {
    constexpr int kSteps = 8;
    const double dx = begun_ ? (x - last_) / kSteps : 0.0;
    for (int i = 0; i < kSteps; ++i) z_ += dx - 0.5 * (std::abs(dx) * z_ + dx * std::abs(z_));
    last_ = x;
    begun_ = true;
    return z_;
  }

 private:
  double z_ = 0.0, last_ = 0.0;
  bool begun_ = false;
};

using Names = std::vector<std::string>;

}  // namespace

const std::vector<FormTruth>& FormTruths() {
  static const std::vector<FormTruth> truths = {
      {"port_grip",
       {"port_friction", "port_position_m"},
       {"insertion_depth", "sliding_velocity"},
       {"step", "saturating", "hysteresis", "other"}},
      {"taper",
       {"stiffness"},
       {"insertion_depth"},
       {"linear", "quadratic", "saturating", "decaying", "other"}},
      {"shaft_tissue",
       {"shaft_load_N_m"},
       {"position", "previous_samples"},
       {"decaying", "hysteresis"}},
      {"second_contact",
       {"shaft_load_N_m"},
       {"position", "orientation", "insertion_depth"},
       {"saturating", "linear", "step", "other"}},
      {"strain_clip", {"strain0_moment_Nm"}, {"own_value"}, {"saturating"}},
      {"strain_hum", {"strain0_moment_Nm"}, {"time"}, {"periodic"}},
      {"em_tool", {"em0_position_m"}, {"position"}, {"decaying", "other"}},
      {"strain_warmup", {"strain0_moment_Nm"}, {"time"}, {"saturating", "decaying"}},
      {"strain_glue", {"strain0_moment_Nm"}, {"own_value", "previous_samples"}, {"hysteresis"}},
      {"camera_knock", {"vision0_position_m"}, {"time"}, {"step"}},
      {"belt_slip", {"wrist0_position_m"}, {"time"}, {"step"}},
      {"lead_screw", {"wrist0_position_m"}, {"own_value"}, {"periodic"}},
      {"load_clip", {"load0_force_N"}, {"own_value", "load"}, {"saturating", "quadratic"}, true},
      {"load_creep",
       {"load0_force_N"},
       {"own_value", "load", "previous_samples"},
       {"decaying"},
       true},
      {"port_slip", {"port_position_m"}, {"time"}, {"step"}},
      {"port_creep", {"port_position_m"}, {"time"}, {"saturating", "decaying"}},
      {"stiffness_warmup", {"stiffness"}, {"time"}, {"saturating", "decaying", "linear"}},
      {"vision_blur", {"vision0_position_m"}, {"distance_to_camera"}, {"quadratic"}},
  };
  return truths;
}

const std::vector<std::string>& LaterForms() {
  static const Names names = [] {
    Names later;
    for (std::size_t i = 5; i < FormTruths().size(); ++i) later.push_back(FormTruths()[i].name);
    return later;
  }();
  return names;
}

HiddenForm::HiddenForm(std::string name, const HiddenScene& scene, Rng& rng)
    : name_(std::move(name)) {
  size_ = Uniform(rng, 0.8, 2.0);
  rate_ = Uniform(rng, 1.3, 9.0);
  time_s_ = Uniform(rng, 0.25, 0.7) * scene.duration_s;
  second_s_ = Uniform(rng, 0.1, 0.3) * scene.duration_s;
  phase_rad_ = Uniform(rng, 0.0, kTurn);
  direction_ = Direction(rng);
  for (double& gage : gages_) gage = Uniform(rng, -1.0, 1.0);
  const WristCourse course = scene.Motion();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double far = 0.0;
  constexpr int kPoints = 40;
  for (int i = 0; i < kPoints; ++i)
    middle +=
        course.StraightPoint(scene.duration_s * i / kPoints, scene.instrument.length_m) / kPoints;
  const Eigen::Vector3d side = Direction(rng);
  for (int i = 0; i < kPoints; ++i)
    far = std::max(far, side.dot(course.StraightPoint(scene.duration_s * i / kPoints,
                                                      scene.instrument.length_m) -
                                 middle));
  place_ = middle + (far + Uniform(rng, 0.03, 0.06)) * side;
}

bool HiddenForm::IsOfPlant() const {
  return name_ == "port_slip" || name_ == "port_creep" || name_ == "stiffness_warmup";
}

void HiddenForm::ActOnPlant(double t_s, const simulation::PlantEffects& at_rest,
                            simulation::PlantEffects& effects) const {
  effects = at_rest;
  const double t = std::max(0.0, t_s);
  if (name_ == "port_slip")  // the trocar slides in its incision
    effects.port_offset_m += 0.0015 * size_ * Slip((t_s - time_s_) / 2.0) * direction_;
  if (name_ == "port_creep") {  // tissue gives way: a power law, not an exponential
    const double gone = 1.0 - 1.0 / std::pow(1.0 + t / (0.3 * second_s_), 0.8);
    effects.port_offset_m += 0.003 * size_ * gone * direction_;
  }
  if (name_ == "stiffness_warmup")  // nitinol in a warm body, its middle later than its skin
    effects.stiffness_scale *=
        1.0 + 0.15 * size_ *
                  (1.0 - 0.6 * std::exp(-t / second_s_) - 0.4 * std::exp(-3.0 * t / second_s_));
}

void HiddenForm::ActOnReadings(Recording& recording) const {
  if (recording.strain0 && name_.starts_with("strain_")) {
    BoucWen glue[4];
    constexpr double kYield_Nm = 0.06;
    for (auto& sample : recording.strain0->moments_Nm) {
      const double t = Seconds(sample.t_ns, recording);
      Eigen::Vector4d& m = sample.value;
      if (name_ == "strain_hum")
        m += 0.006 * size_ * Triangle(rate_ * t + phase_rad_ / kTurn) * gages_;
      if (name_ == "strain_warmup")  // of the gage and of the shaft beneath it
        m += 0.012 * size_ *
             (1.0 - 0.65 * std::exp(-t / second_s_) - 0.35 * std::exp(-4.0 * t / second_s_)) *
             gages_;
      if (name_ == "strain_glue")
        for (int i = 0; i < 4; ++i) m[i] -= 0.008 * size_ * glue[i].Next(m[i] / kYield_Nm);
    }
  }
  if (recording.em0 && name_ == "em_tool") {  // the field of a dipole induced in a tool
    for (auto& sample : recording.em0->samples) {
      const Eigen::Vector3d r = sample.value.p_RS - place_;
      const Eigen::Vector3d u = r.normalized();
      const double near = std::pow(0.05 / std::max(0.02, r.norm()), 3);
      sample.value.p_RS += 0.004 * size_ * near * (3.0 * u.dot(direction_) * u - direction_);
    }
  }
  if (recording.vision0 && (name_ == "camera_knock" || name_ == "vision_blur")) {
    const Pose& T_RC = recording.cam0->calibration.T_RC;
    double nearest = 1e9, farthest = 0.0;
    for (const auto& sample : recording.vision0->tips) {
      nearest = std::min(nearest, (sample.value.p_RE - T_RC.p).norm());
      farthest = std::max(farthest, (sample.value.p_RE - T_RC.p).norm());
    }
    for (auto& sample : recording.vision0->tips) {
      const double t = Seconds(sample.t_ns, recording) - time_s_;
      Eigen::Vector3d& p = sample.value.p_RE;
      if (name_ == "camera_knock" && t > 0.0)  // the arm rings, and stays where it came to rest
        p += 0.0015 * size_ * (1.0 - std::exp(-t / 0.15) * std::cos(kTurn * 4.0 * t)) * direction_;
      if (name_ == "vision_blur") {  // out of focus at both ends, edges grow and the tip seems near
        const Eigen::Vector3d sight = p - T_RC.p;
        const double x = (2.0 * sight.norm() - nearest - farthest) / (farthest - nearest);
        p -= 0.004 * size_ * x * x * sight.normalized();
      }
    }
  }
  if (recording.wrist0 && (name_ == "belt_slip" || name_ == "lead_screw")) {
    for (auto& sample : recording.wrist0->samples) {
      const double t = Seconds(sample.t_ns, recording);
      Eigen::Vector3d& p = sample.value.p_RW;
      if (name_ == "belt_slip") p += 0.0012 * size_ * Slip(t - time_s_) * direction_;
      // The thread of the axis along R's y, once every 20 to 30 mm: sharper than a sine.
      if (name_ == "lead_screw")
        p.y() += 0.0006 * size_ * Triangle(p.y() / (0.02 + 0.001 * rate_) + phase_rad_ / kTurn);
    }
  }
  if (recording.load0 && name_.starts_with("load_")) {
    double largest = 1e-6;
    for (const auto& sample : recording.load0->f_tip_N)
      largest = std::max(largest, sample.value.cwiseAbs().maxCoeff());
    const double limit = 0.7 / std::sqrt(size_) * largest;
    Eigen::Vector3d slow = Eigen::Vector3d::Zero();
    double last = 0.0;
    for (auto& sample : recording.load0->f_tip_N) {
      const double t = Seconds(sample.t_ns, recording);
      if (name_ == "load_clip")  // the amplifier's own limit, approached smoothly
        for (double& f : sample.value) f = limit * std::atan(f / limit);
      if (name_ == "load_creep") {  // the cell's body gives way by a part and comes back
        if (last == 0.0) slow = sample.value;
        slow += (1.0 - std::exp(-(t - last) / (0.25 * second_s_))) * (sample.value - slow);
        last = t;
        sample.value -= 0.15 * size_ * (sample.value - slow);
      }
    }
  }
}

}  // namespace flextip::hidden
