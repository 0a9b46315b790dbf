#include "simulation/closed_loop/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "estimation/shaft_estimator.h"

namespace flextip::simulation {
namespace {

EstimatorOptions MakeEstimatorOptions(const LoopSetup& setup) {
  EstimatorOptions options;
  options.instrument = setup.base.instrument;
  options.p_RP = setup.base.p_RP;
  options.gravity_m_s2 = setup.base.gravity_m_s2;
  options.port_prior_m = setup.port_prior_m;
  options.use_positions = UsesTipMeasurement(setup.controller.kind);
  return options;
}

/// With a camera, the tip is what vision sees, not what a figure says it would.
SensorSetup WithoutTipIf(bool camera, SensorSetup sensors) {
  if (camera) sensors.tip.reset();
  return sensors;
}

/// One run of the loop.
class Loop {
 public:
  Loop(const LoopSetup& setup, const LoopCamera* camera)
      : setup_(setup),
        camera_(camera),
        plant_(setup.plant, setup.plant_options),
        sensors_(WithoutTipIf(camera != nullptr, setup.sensors), setup.seed, setup.sensor_effects),
        model_(setup.model ? setup.model() : nullptr),
        estimator_(MakeEstimatorOptions(setup)),
        controller_(setup.controller),
        p_RW_(setup.p_RW_start),
        p_RW_command_(setup.p_RW_start) {
    result_.recording = setup.base;
    if (camera_ != nullptr) StartCamera();
    shape_ = plant_.Solve(p_RW_);
    if (!shape_.IsUsable()) {
      throw InputError(
          fmt::format("the shaft has no equilibrium at the start: {}", shape_.message));
    }
    path_.emplace(setup.path, shape_.T_RE().p, setup.update_rate_hz);
  }

  LoopResult Run(const std::function<void(int, int)>& progress) {
    const double tick_rate_hz = TickRate();
    const int ticks_per_update =
        static_cast<int>(std::lround(tick_rate_hz / setup_.update_rate_hz));
    const int total = path_->MaxUpdates();
    for (int tick = 0; !path_->Done(); ++tick) {
      t_ns_ = kSimulationStart_ns + std::llround(tick * 1e9 / tick_rate_hz);
      if (tick > 0) MoveWrist(1.0 / tick_rate_hz);
      Sense();
      if (tick % ticks_per_update == 0) {
        Update();
        if (progress) progress(static_cast<int>(result_.updates.size()), total);
      }
      Score(tick % ticks_per_update == 0);
    }
    Finish();
    return std::move(result_);
  }

 private:
  /// Sensors faster than the camera are sampled between its frames.
  double TickRate() const {
    double fastest = setup_.update_rate_hz;
    const auto consider = [&](const auto& sensor) {
      if (sensor) fastest = std::max(fastest, sensor->rate_hz);
    };
    consider(setup_.sensors.wrist);
    consider(setup_.sensors.em0);
    consider(setup_.sensors.em1);
    consider(setup_.sensors.strain);
    consider(setup_.sensors.load);
    return setup_.update_rate_hz * std::ceil(fastest / setup_.update_rate_hz - 1e-9);
  }

  void StartCamera() {
    const CameraStream& stream = *setup_.base.cam0;
    tracker_.emplace(stream.calibration, *setup_.base.tags0, camera_->tracker);
    result_.recording.vision0.emplace();
    result_.recording.vision0->comment = "tip by vision, as the loop saw it";
    result_.recording.vision0->rate_hz = setup_.update_rate_hz;
  }

  void MoveWrist(double dt_s) {
    const Eigen::Vector3d left = p_RW_command_ - p_RW_;
    const double reach = setup_.max_wrist_speed_m_s * dt_s;
    p_RW_ += left.norm() > reach ? Eigen::Vector3d(reach / left.norm() * left) : left;
    shape_ = plant_.Solve(p_RW_, 1e-9 * static_cast<double>(t_ns_ - kSimulationStart_ns));
    if (!shape_.IsUsable()) {
      throw WorkError(fmt::format("the shaft lost its equilibrium {:.3f} s into the run: {}",
                                  static_cast<double>(t_ns_ - kSimulationStart_ns) * 1e-9,
                                  shape_.message));
    }
  }

  void Sense() {
    sensors_.Sample(shape_, t_ns_, result_.recording);
    result_.truth.push_back({t_ns_, {shape_.T_RE().p, shape_.T_RE().Quaternion(), p_RW_}});
  }

  /// The camera's frame, rendered, kept, and tracked as a recorded one would be.
  void See() {
    const int number = static_cast<int>(result_.recording.cam0->filenames.size());
    const Image frame = camera_->laparoscope.Render(shape_.Curve(), number);
    result_.recording.cam0->filenames.push_back({t_ns_, fmt::format("{}.png", t_ns_)});
    if (camera_->save) camera_->save(t_ns_, frame);
    const TipTrack track = tracker_->Track(frame, t_ns_);
    result_.recording.vision0->tips.push_back({t_ns_, track.tip});
    direction_noise_rad_ = track.direction_noise_rad;
    if (track.tip.d_RE) {
      squared_direction_noise_ += track.direction_noise_rad * track.direction_noise_rad;
      ++directions_;
    }
  }

  /// What the sensors have said by now: each one's last sample, and the tip only if it is new.
  Measurements Gather() const {
    const Recording& r = result_.recording;
    Measurements z;
    const WristSample& wrist = r.wrist0->samples.back().value;
    z.p_RW = wrist.p_RW;
    z.wrist_position_noise_m = r.wrist0->position_noise_m;
    if (wrist.q_RW) z.R_RW = wrist.q_RW->toRotationMatrix();
    z.wrist_orientation_noise_rad = r.wrist0->orientation_noise_rad;
    if (r.vision0 && !r.vision0->tips.empty() && r.vision0->tips.back().t_ns == t_ns_) {
      z.tip = r.vision0->tips.back().value;
      z.tip_direction_noise_rad =
          camera_ != nullptr ? direction_noise_rad_ : r.vision0->direction_noise_rad;
    }
    if (r.em0 && !r.em0->samples.empty()) {
      const EmSample& em = r.em0->samples.back().value;
      z.em = EmMeasurement{Pose::FromQuaternion(em.q_RS, em.p_RS), r.em0->distance_from_tip_m,
                           r.em0->position_noise_m, r.em0->orientation_noise_rad};
    }
    if (r.em1 && !r.em1->samples.empty()) {
      z.port_direction = r.em1->samples.back().value.q_RS.toRotationMatrix().col(0);
      z.port_direction_noise_rad = r.em1->orientation_noise_rad;
    }
    if (r.strain0 && !r.strain0->moments_Nm.empty()) {
      z.strain = StrainMeasurement{
          r.strain0->moments_Nm.back().value,
          {r.strain0->station_from_wrist_m[0], r.strain0->station_from_wrist_m[1]},
          r.strain0->moment_noise_Nm};
    }
    if (r.load0 && !r.load0->f_tip_N.empty()) {
      z.load = LoadMeasurement{r.load0->f_tip_N.back().value, r.load0->force_noise_N};
    }
    return z;
  }

  void Update() {
    if (camera_ != nullptr) See();
    const Measurements measured = Gather();
    if (model_) model_->Advance(t_ns_, measured, f_tip_N_);
    const Measurements z = model_ ? model_->Correct(measured) : measured;
    ControlInput input;
    input.p_RW = z.p_RW;
    const ShaftEstimate estimate = estimator_.Update(z, model_ ? model_->Shaft() : ShaftChange());
    f_tip_N_ = estimate.model.f_tip_N;
    input.model = estimate.model;
    if (z.tip && z.tip->status != TipStatus::kLost) {
      input.tip_measured = true;
      // The thesis's controllers take the tip as its sensor gives it; ours as all sensors give it.
      const bool fused = setup_.controller.kind == ControllerKind::kRodTrack &&
                         estimate.status == EstimateStatus::kOk;
      input.p_RE_measured = fused ? estimate.p_RE : z.tip->p_RE;
    }
    input.p_RE_desired = path_->Advance(p_RE_known_.value_or(input.p_RE_measured));
    const ControlOutput output = controller_.Step(input);
    if (output.status != ControlStatus::kNoTip) p_RE_known_ = output.p_RE_used;
    // The arm is commanded from where its encoders say it is.
    p_RW_command_ = output.p_RW_command + (p_RW_ - z.p_RW);
    Note(input, output);
  }

  void Note(const ControlInput& input, const ControlOutput& output) {
    if (!result_.recording.command0) {
      result_.recording.command0.emplace();
      result_.recording.command0->comment = Name(setup_.controller.kind);
      result_.recording.command0->rate_hz = setup_.update_rate_hz;
    }
    result_.recording.command0->p_RW.push_back({t_ns_, output.p_RW_command});
    ++result_.control_statuses[Name(output.status)];
    if (result_.recording.vision0 && !result_.recording.vision0->tips.empty()) {
      ++result_.tip_statuses[Name(result_.recording.vision0->tips.back().value.status)];
    }
    result_.steps_limited += output.step_limited;
    result_.steps_damped += output.damped;
    LoopUpdate update;
    update.t_ns = t_ns_;
    update.p_RE_desired = input.p_RE_desired;
    update.p_RE = shape_.T_RE().p;
    update.status = output.status;
    result_.updates.push_back(update);
  }

  /// Scoring, with the truth: how far the tip is from the path.
  void Score(bool at_update) {
    const double deviation = path_->Deviation(shape_.T_RE().p);
    if (at_update) result_.updates.back().deviation_m = deviation;
    result_.max_deviation_m = std::max(result_.max_deviation_m, deviation);
    squared_deviation_ += deviation * deviation;
    ++scored_;
  }

  void Finish() {
    result_.rms_deviation_m = std::sqrt(squared_deviation_ / scored_);
    result_.final_error_m = (shape_.T_RE().p - result_.updates.back().p_RE_desired).norm();
    if (directions_ > 0) {
      result_.recording.vision0->direction_noise_rad =
          std::sqrt(squared_direction_noise_ / directions_);
    }
  }

  const LoopSetup& setup_;
  const LoopCamera* camera_;
  Plant plant_;
  Sensors sensors_;
  std::unique_ptr<InstrumentModel> model_;
  ShaftEstimator estimator_;
  TipController controller_;
  std::optional<TipTracker> tracker_;
  std::optional<TipPath> path_;
  PlantShape shape_;
  Eigen::Vector3d p_RW_, p_RW_command_;
  Eigen::Vector3d f_tip_N_ = Eigen::Vector3d::Zero();  // as estimated last
  std::optional<Eigen::Vector3d> p_RE_known_;
  TimeNs t_ns_ = kSimulationStart_ns;
  double direction_noise_rad_ = 0.0, squared_direction_noise_ = 0.0, squared_deviation_ = 0.0;
  int directions_ = 0, scored_ = 0;
  LoopResult result_;
};

}  // namespace

LoopResult RunClosedLoop(const LoopSetup& setup, const LoopCamera* camera,
                         const std::function<void(int, int)>& progress) {
  return Loop(setup, camera).Run(progress);
}

}  // namespace flextip::simulation
