// One control cycle, from sensor samples to the wrist's command: the loop as a library.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <optional>
#include <span>

#include "control/controller.h"
#include "control/direction_controller.h"
#include "control/fixtures.h"
#include "control/supervision/correction_limit.h"
#include "control/supervision/motion_guard.h"
#include "control/supervision/path_watch.h"
#include "control/supervision/rate_limits.h"
#include "control/supervision/supervisor.h"
#include "core/image.h"
#include "estimation/instrument_model.h"
#include "estimation/watch/instrument_watch.h"
#include "pipeline/guard/sensor_guard.h"
#include "pipeline/instrument_estimator.h"
#include "pipeline/instrument_tracker.h"
#include "pipeline/late_samples.h"
#include "pipeline/sensor_readings.h"

namespace flextip {

struct InstrumentControllerOptions {
  EstimatorOptions estimator;  ///< from EstimatorOptionsFor; `use_positions` follows control.kind
  int window_samples = 0;      ///< of the window estimator; 0: each sample by itself
  ControllerOptions control;
  /// Where there, a cycle that is given a direction controls place and direction by the exact rod;
  /// needs a rod kind.
  std::optional<DirectionOptions> direction;
  /// With kPositionFirst: the place along it does not matter (any length; zero: all of it does).
  Eigen::Vector3d direction_free_axis = Eigen::Vector3d::Zero();
  Fixtures fixtures;
  bool em_is_tip = false;  ///< without vision, em0 carried to the tip is the tip's measurement
  /// The straight kinds pivot at the port as registered, not as estimated.
  bool straight_at_registered_port = false;
  LateSampleOptions late;  ///< how late samples are carried on to the cycle's wrist
  /// Of the cycles, for GainUnderDelay and the part of a correction that each makes; 0: the gain
  /// stays as it is, and each corrects wholly.
  double rate_hz = 0.0;
  SupervisorOptions supervision;  ///< none unless its `kind` says so
};

/// The inputs of a cycle. Fixed size but for the pictures, which stay the caller's.
struct ControllerInputs {
  TimeNs t_ns = 0;                         ///< of the cycle; not before the last one
  SensorReadings sensors;                  ///< the newest sample of each stream; a tip counts once
  std::span<const Image* const> pictures;  ///< one a camera, null: none of it; empty: no picture
  TimeNs pictures_t_ns = 0;
  std::optional<Eigen::Vector3d> p_RE_desired;  ///< absent: the cycle only watches
  std::optional<Eigen::Vector3d> d_RE_desired;  ///< the tip's direction, any length
  bool resume = false;                          ///< a person ends a fault
};

/// The result of a cycle. Fixed size; all in R.
struct ControllerCommand {
  TimeNs t_ns = 0;
  ControlStatus status = ControlStatus::kNoWrist;
  Eigen::Vector3d p_RW_command = Eigen::Vector3d::Zero();  ///< means nothing with kNoWrist
  Eigen::Vector3d p_RE_used = Eigen::Vector3d::Zero();     ///< the tip the step started from
  bool step_limited = false, damped = false;               ///< as in ControlOutput
  Measurements measurements;                               ///< gathered, seen and corrected
  ShaftEstimate estimate;
  std::optional<Eigen::Vector3d> p_RE_measured;  ///< the tip as the controller was given it
  FixturesOutput goal;                           ///< the wish, kept by the fixtures
  Eigen::Matrix3d J_tip_wrist = Eigen::Matrix3d::Zero();  ///< that the step used; zero: none
  Supervision supervision;  ///< the supervisor's findings; p_RW_command is what it let through
  FoundCause cause;         ///< by the watch: a warning, which changes no command
};

/// The whole cycle. A function of its inputs and its own state: the same inputs give the same
/// commands, bit for bit. Without pictures it allocates nothing once it runs.
class InstrumentController {
 public:
  /// Takes the `model` of instrument and sensors that a diagnosis found; null: as their data say.
  /// `tracker` sees the tip where a cycle is given pictures. `watch` looks for causes of misfit.
  /// Throws InputError where `options.direction` comes without a rod kind.
  explicit InstrumentController(const InstrumentControllerOptions& options,
                                std::unique_ptr<InstrumentModel> model = nullptr,
                                std::unique_ptr<InstrumentTracker> tracker = nullptr,
                                std::unique_ptr<InstrumentWatch> watch = nullptr);

  /// Runs one cycle. Throws InputError only for pictures of the wrong size.
  ControllerCommand Step(const ControllerInputs& inputs);

  /// Takes how well the times of the tip's and of em0's samples are known from now on, in the place
  /// of LateSampleOptions'. The gain follows. Allocates nothing.
  void SetTimeDeviations(double tip_sd_s, double em0_sd_s);

  /// Takes the command that really went out in the last cycle, where the caller limited it further.
  void NoteSent(const Eigen::Vector3d& p_RW) {
    supervisor_.NoteSent(p_RW);
    if (sent_) sent_->p_RW = p_RW;
  }

  /// Visits what the next step starts from, bit for bit: a controller of the same options goes on
  /// where the other was. Not for one with a tracker.
  void VisitState(StateText& state);

  /// Returns the tracker's result for the last pictures; empty before the first.
  const std::optional<TipTrack>& Track() const { return track_; }
  /// Returns the gain that the controllers have, with the delay's part taken off.
  double Gain() const { return place_.Options().gain; }
  /// Returns the window's last estimate; null without a window.
  const WindowEstimate* Window() const { return estimator_.Window(); }

 private:
  SensorReadings See(const ControllerInputs& inputs, Supervision& found);
  SensorReadings Carry(SensorReadings seen, Supervision& found);
  bool EstimateThen(const SensorReadings& seen, Supervision& found);
  void SeeBySensors(const SensorReadings& seen);
  void Learn(TimeNs t_ns, const ShaftEstimate& estimate);
  Measurements Correct(TimeNs t_ns, const Measurements& measured);
  ShaftEstimate Estimate(TimeNs t_ns, const Measurements& measurements);
  std::optional<VotedShaft> Vote(TimeNs t_ns, Measurements& z, Supervision& found);
  void Fuse(ControllerCommand& command);
  void ForgetSources();
  FixturesOutput Keep(const ControllerInputs& inputs, const ShaftEstimate& estimate) const;
  void Control(const ControllerInputs& inputs, ControllerCommand& command);
  void ControlPlace(ControllerCommand& command);
  void ControlDirection(const Eigen::Vector3d& d_RE_desired, ControllerCommand& command);
  bool MayPointWrong(ControllerCommand& command);
  Limited Corrected(const ControllerCommand& command);
  Limited KeptToWay(const ControllerCommand& command, const Limited& wish);
  bool LosesItsLoad(const ControllerCommand& command) const;
  Eigen::Vector3d WayOfTip(const Eigen::Vector3d& p_RW);
  void Supervise(const ControllerInputs& inputs, ControllerCommand& command);
  void KeepSent(const ControllerCommand& command);
  void LookFor(TimeNs t_ns, const SensorReadings& readings, const Measurements& z);
  void Watch(const ControllerInputs& inputs, ControllerCommand& command);

  InstrumentControllerOptions options_;
  std::unique_ptr<InstrumentModel> model_;
  std::unique_ptr<InstrumentTracker> tracker_;
  std::unique_ptr<InstrumentWatch> watch_;
  InstrumentEstimator estimator_;
  TipController place_;
  std::optional<DirectionController> direction_;
  std::optional<TipTrack> track_;
  std::optional<TimeNs> tip_t_ns_;  // of the last tip that counted
  bool tip_is_hidden_ = false;      // in the newest sample of it
  SensorGuard guard_;
  MotionGuard motion_guard_;
  Supervisor supervisor_;
  PathWatch path_watch_;
  std::optional<VotedShaft> by_all_;  // of this cycle
  std::optional<Eigen::Vector3d> p_RW_watched_, p_goal_last_;
  std::optional<SentCommand> sent_;  // in the last cycle, if it acted
  CorrectionLimit about_command_;
  int corrections_ = 0;                                 // limited ones in a row, in one direction
  Eigen::Vector3d excess_m_ = Eigen::Vector3d::Zero();  // of the last one
  // Where the tip's source changes, the difference is taken up slowly.
  bool by_others_ = false;
  std::optional<Eigen::Vector3d> p_RE_last_;
  Eigen::Vector3d p_RW_last_ = Eigen::Vector3d::Zero();  // of p_RE_last_
  Eigen::Vector3d p_RE_offset_ = Eigen::Vector3d::Zero();
  // Where tips are late, or come more seldom than cycles. Tissue and port are learnt from what was
  // measured at one time, by estimator_; between_ fits the tip that is carried on.
  InstrumentEstimator between_;
  ShaftEstimator without_tip_;
  LateSamples late_;
  bool carries_ = false;                               // once a tip was carried on
  bool tip_is_carried_ = false;                        // in this cycle
  ShaftModel shaft_;                                   // as estimator_ said last
  Eigen::Vector3d f_tip_N_ = Eigen::Vector3d::Zero();  // as estimated last
};

}  // namespace flextip
