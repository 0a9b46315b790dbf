#include "reproduction/chapter5/trial.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "control/virtual_fixture.h"
#include "estimation/slope_fit.h"
#include "pipeline/sensor_readings.h"
#include "pipeline/tip_fusion.h"
#include "reproduction/chapter5/setup.h"
#include "reproduction/chapter5/wrist.h"
#include "simulation/plant/plant.h"
#include "simulation/tissue/soft_cylinder.h"

namespace flextip::reproduction {
namespace {

constexpr double kLevelling_s = 0.5;  // time constant

bool IsStraight(ControllerKind kind) {
  return kind == ControllerKind::kStraightCalculate || kind == ControllerKind::kStraightTrack;
}
/// The thesis's own fit (5.4)-(5.12): from the directions at wrist and tip and the measured chord.
bool UsesClosedForm(const TrialSetup& setup) {
  return setup.kind == ControllerKind::kFlexTrack ||
         (setup.kind == ControllerKind::kFlexCalculate && setup.chord_measured);
}

class TrialRun {
 public:
  TrialRun(const TrialSetup& setup, const TrialPlaces& places)
      : setup_(setup),
        places_(places),
        tick_hz_(TickRate(setup)),
        silicone_(MakeSilicone()),
        plant_(MakePlant(), {setup.links, setup.links}),
        sensors_(MakeSensors(setup, places), setup.noise_seed, Errors()),
        estimator_(MakeEstimator(setup, places)),
        controller_(MakeController(setup)),
        operator_(MakeTask(places), simulation::DrawOperator(setup.operator_seed),
                  setup.noise_seed + 1000),
        occlusions_(setup.noise_seed + 7) {
    recording_.instrument = Rod();
    recording_.p_RP = places.p_RP;
  }

  Trial Run() {
    trial_.rate_hz = tick_hz_;
    const double start_x = places_.surface_x_m - 0.006 - Rod().length_m;
    Eigen::Vector3d p_RW(start_x, 0.0, 0.0);
    shape_ = plant_.Solve(p_RW);
    wrist_.emplace(p_RW, -shape_.f_wrist_N,
                   ServoWristSetup{.stiffness_N_m = setup_.arm_stiffness_N_m});
    command_ = p_RW;
    const int ticks = static_cast<int>(setup_.seconds * tick_hz_);
    const int per_update = static_cast<int>(std::lround(tick_hz_ / setup_.update_rate_hz));
    for (int tick = 0; tick < ticks && !trial_.lost; ++tick) {
      t_ns_ = simulation::kSimulationStart_ns + std::llround(tick * 1e9 / tick_hz_);
      if (tick > 0) Move();
      if (trial_.lost) break;
      Ask();
      Sense();
      if (tick % per_update == 0) Update();
      Note();
    }
    Finish();
    return std::move(trial_);
  }

 private:
  simulation::SoftCylinder MakeSilicone() const {
    simulation::SoftCylinderSetup silicone = simulation::SiliconeOf(
        simulation::Silicone(), Rod().outer_diameter_m, setup_.silicone_scale);
    silicone.p_surface = {places_.surface_x_m, 0.0, 0.0};
    return simulation::SoftCylinder(silicone);
  }

  simulation::PlantSetup MakePlant() {
    simulation::PlantSetup plant;
    plant.instrument = Rod();
    plant.p_RP = places_.p_RP;
    plant.weight_N_m = Rod().mass_per_length_kg_m * kGravity;
    plant.effects.stiffness_scale = 1.0 + setup_.stiffness_error;
    plant.effects.length_delta_m = setup_.length_error_m;
    plant.effects.port_offset_m = setup_.port_error_m * Eigen::Vector3d(0.0, 1.0, 1.0).normalized();
    if (!setup_.hold_still)
      plant.load.other = [this](const Eigen::Vector3d& p) { return silicone_.At(p); };
    return plant;
  }

  simulation::SensorEffects Errors() const {
    simulation::SensorEffects effects;
    effects.camera_latency_s = setup_.vision_latency_s;
    effects.em_latency_s = setup_.em_latency_s;
    effects.em_offset_m = setup_.em_offset_m * Eigen::Vector3d::UnitX();
    return effects;
  }

  void Move() {
    wrist_->Move(command_, -shape_.f_wrist_N, 1.0 / tick_hz_);
    const simulation::PlantShape next = plant_.Solve(
        wrist_->Position(), 1e-9 * static_cast<double>(t_ns_ - simulation::kSimulationStart_ns));
    trial_.lost = !next.IsUsable();
    if (trial_.lost) return;
    shape_ = next;
    silicone_.MoveTo(shape_.T_RE().p);
  }

  /// What the operator asks for.
  void Ask() {
    if (setup_.hold_still) {
      p_RE_asked_ = {places_.surface_x_m - 0.006, 0.0, 0.0};
    } else {
      p_RE_asked_ = operator_.Step(1.0 / tick_hz_, shape_.T_RE().p);
    }
  }

  void Sense() {
    sensors_.Sample(shape_, t_ns_, recording_);
    hidden_ = setup_.occlusions && occlusions_.Step(1.0 / tick_hz_);
    const EmSample& em = recording_.em0->samples.back().value;
    p_RE_em_ = em.p_RS + kSensorFromTip_m * (em.q_RS * Eigen::Vector3d::UnitX());
    p_RW_before_.push_back(wrist_->Position());
  }

  /// What the sensors say of one instant: with EM of now, with a camera of when the frame was
  /// taken.
  void Gather() {
    const auto& wrists = recording_.wrist0->samples;
    std::size_t age = 0;
    if (setup_.sense == TipSense::kVision) {
      age = std::min(static_cast<std::size_t>(std::lround(setup_.vision_latency_s * tick_hz_)),
                     wrists.size() - 1);
    }
    SensorReadings readings;
    const Sample<WristSample>& wrist = wrists[wrists.size() - 1 - age];
    readings.wrist = {wrist.t_ns, Measured(*recording_.wrist0, wrist.value)};
    p_RW_then_ = p_RW_before_[p_RW_before_.size() - 1 - age];
    const SensorReadings newest = NewestReadings(recording_);
    if (setup_.sense == TipSense::kVision) {
      if (!hidden_) readings.tip = newest.tip;
      z_ = *flextip::Gather(readings);
      return;
    }
    readings.em0 = newest.em0;
    z_ = *flextip::Gather(readings);
    if (!UsesClosedForm(setup_)) return;
    z_.tip.emplace();  // the thesis's closed forms take the tip by itself
    z_.tip->status = TipStatus::kOk;
    z_.tip->p_RE = p_RE_em_;
    z_.tip->covariance_m2 = std::pow(setup_.em_position_noise_m, 2) * Eigen::Matrix3d::Identity();
  }

  /// A port that is far from the registered one is not believed: near-straight shafts put it
  /// anywhere.
  BeamFit ClosedForm() const {
    constexpr double kPortAgreement = 0.05;  // of the length
    const double length = Rod().length_m;
    SlopeNoise noise;
    noise.wrist_rad = z_.wrist_orientation_noise_rad;
    noise.tip_rad = z_.em ? z_.em->orientation_noise_rad : z_.tip_direction_noise_rad;
    noise.chord_rad = std::sqrt(z_.tip->covariance_m2.trace() / 3.0) / length;
    const Eigen::Vector3d t_tip = z_.em ? Eigen::Vector3d(z_.em->T_RS.R.col(0)) : *z_.tip->d_RE;
    BeamFit fit = FitFromSlopes(z_.p_RW, z_.tip->p_RE, z_.R_RW->col(0), t_tip, length, noise);
    if (std::abs(fit.a - (places_.p_RP - z_.p_RW).norm()) > kPortAgreement * length) {
      fit.status = BeamStatus::kStraight;
    }
    return fit;
  }

  /// The tip as the controller is given it, and how well it is known.
  void FindTip(const ShaftEstimate& estimate, ControlInput& input) {
    input.tip_measured = setup_.sense == TipSense::kEm || !hidden_;
    if (!input.tip_measured) return;
    input.p_RE_measured = *MeasuredTip(z_, true);
    tip_variance_m2_ = std::pow(setup_.em_position_noise_m, 2);
    if (setup_.kind != ControllerKind::kRodTrack || estimate.status != EstimateStatus::kOk) return;
    if (setup_.level_tip) {
      const double part = std::min(1.0, 1.0 / (kLevelling_s * setup_.update_rate_hz));
      level_m_ += part * (input.p_RE_measured - estimate.p_RE - level_m_);
    }
    input.p_RE_measured = estimate.p_RE + level_m_;
    tip_variance_m2_ = estimate.p_RE_covariance_m2(0, 0);
  }

  void Update() {
    Gather();
    ControlInput input;
    input.p_RW = z_.p_RW;
    input.model.instrument = Rod();
    input.model.p_RP = places_.p_RP;
    ShaftEstimate estimate;
    if (!hidden_ && UsesClosedForm(setup_)) {
      input.model.beam = ClosedForm();
    } else if (!hidden_ && !IsStraight(setup_.kind)) {
      estimate = estimator_.Update(z_);
      input.model = estimate.model;
    }
    FindTip(estimate, input);
    const ForbiddenHalfSpace wall{{places_.WallX(), 0.0, 0.0}, -Eigen::Vector3d::UnitX()};
    input.p_RE_desired =
        Constrain(wall, p_RE_asked_, setup_.margin_sd * std::sqrt(tip_variance_m2_)).p_RE_desired;
    const ControlOutput output = controller_.Step(input);
    p_RE_desired_ = input.p_RE_desired;
    ++updates_;
    trial_.straight_part += output.status == ControlStatus::kStraightInstead;
    trial_.no_tip_part += output.status == ControlStatus::kNoTip;
    // The arm goes by its encoders: relative to where they had it when the tip was measured.
    if (output.status != ControlStatus::kNoTip) {
      command_ = output.p_RW_command + (p_RW_then_ - z_.p_RW);
    }
  }

  void Note() {
    const Eigen::Vector3d p_RE = shape_.T_RE().p;
    trial_.tips.push_back(p_RE);
    trial_.recorded.push_back(p_RE_em_);
    const Eigen::Vector3d axis = (places_.p_RP - wrist_->Position()).normalized();
    const Eigen::Vector3d from_port = p_RE - places_.p_RP;
    const double flexion = (from_port - axis.dot(from_port) * axis).norm();
    trial_.max_flexion_m = std::max(trial_.max_flexion_m, flexion);
    trial_.rms_flexion_m += flexion * flexion;
    const double side = shape_.f_tip_N.tail<2>().norm();
    trial_.max_side_force_N = std::max(trial_.max_side_force_N, side);
    trial_.rms_side_force_N += side * side;
    trial_.max_push_N = std::max(trial_.max_push_N, -shape_.f_tip_N.x());
    trial_.rms_error_m += (p_RE_desired_ - p_RE).squaredNorm() / 3.0;
    trial_.rms_recorded_error_m += (p_RE_desired_ - p_RE_em_).squaredNorm() / 3.0;
  }

  void Finish() {
    const double count = std::max<double>(1.0, static_cast<double>(trial_.tips.size()));
    trial_.rms_flexion_m = std::sqrt(trial_.rms_flexion_m / count);
    trial_.rms_side_force_N = std::sqrt(trial_.rms_side_force_N / count);
    trial_.rms_error_m = std::sqrt(trial_.rms_error_m / count);
    trial_.rms_recorded_error_m = std::sqrt(trial_.rms_recorded_error_m / count);
    trial_.cut_part = silicone_.CutPart(places_.outline_radius_m);
    trial_.straight_part /= std::max(1, updates_);
    trial_.no_tip_part /= std::max(1, updates_);
  }

  const TrialSetup& setup_;
  const TrialPlaces& places_;
  double tick_hz_;
  simulation::SoftCylinder silicone_;
  simulation::Plant plant_;
  simulation::Sensors sensors_;
  ShaftEstimator estimator_;
  TipController controller_;
  simulation::SimulatedOperator operator_;
  Occlusions occlusions_;
  std::optional<ServoWrist> wrist_;
  Recording recording_;
  simulation::PlantShape shape_;
  Measurements z_;
  TimeNs t_ns_ = simulation::kSimulationStart_ns;
  Eigen::Vector3d command_, p_RE_asked_, p_RE_desired_, p_RE_em_, p_RW_then_;
  std::vector<Eigen::Vector3d> p_RW_before_;
  Eigen::Vector3d level_m_ = Eigen::Vector3d::Zero();
  double tip_variance_m2_ = 0.0;
  bool hidden_ = false;
  int updates_ = 0;
  Trial trial_;
};

}  // namespace

Trial RunTrial(const TrialSetup& setup, const TrialPlaces& places) {
  const auto run = std::make_unique<TrialRun>(setup, places);
  return run->Run();
}

}  // namespace flextip::reproduction
