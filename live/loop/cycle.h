// One cycle of live control, without clock, threads or sockets: the newest samples in, the robot's
// set-point out. Control runs it on live streams, replay on recorded ones.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <optional>

#include "control/supervision/jerk_filter.h"
#include "control/tip_path.h"
#include "core/robot/crtk.h"
#include "estimation/watch/instrument_watch.h"
#include "live/loop/holds.h"
#include "pipeline/instrument_controller.h"

namespace flextip::live {

/// A cycle's result. Fixed size; in R.
struct CycleOutputs {
  TimeNs t_ns = 0;
  Hold hold = Hold::kStaleWrist;
  int held_by = -1;          ///< the stream, with kSourceLost; kRobotPeer, kGoalPeer
  bool has_command = false;  ///< false before the wrist was ever measured
  Eigen::Vector3d p_RW_command = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_RW = Eigen::Matrix3d::Identity();  ///< as measured
  ControlStatus status = ControlStatus::kNoWrist;
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();  ///< the tip as the controller last knew it
  std::optional<Eigen::Vector3d> p_RE_goal;        ///< kept by fixtures and workspace
  bool step_limited = false, speed_limited = false, acceleration_limited = false;
  bool workspace_limited = false, fixture_limited = false;
  std::optional<CrtkCommand> state_command;  ///< to send to the robot
  bool done = false;                         ///< the path was run to its end
  std::optional<Supervision> supervision;    ///< the supervisor's findings; empty: no step was made
  FoundCause cause;                          ///< that the running diagnosis found: a warning
};

/// Returns what the controller of a session is made of, and its found model; null for none.
InstrumentControllerOptions OptionsOf(const Session& session);
std::unique_ptr<InstrumentModel> ModelOf(const Session& session);

class Cycle {
 public:
  /// `wait`: somebody else homes and enables the robot. Throws InputError where the session's
  /// controller cannot be made.
  explicit Cycle(const Session& session, bool wait = false);

  /// Runs one cycle. A function of its inputs and its own state, bit for bit; allocates nothing
  /// once the path has begun.
  CycleOutputs Step(const CycleInputs& inputs);

  /// The controller's result behind the last step, with the estimate; kNoWrist before the first.
  const ControllerCommand& LastCommand() const { return command_; }
  /// The path that the tip follows; null before it starts.
  const TipPath* Path() const { return path_ ? &*path_ : nullptr; }

  /// Visits what the next step starts from, bit for bit: a cycle of the same session goes on where
  /// the other was. Throws InputError where the text is of another session.
  void VisitState(StateText& state);
  /// Returns the newest samples as the controller is given them.
  SensorReadings Readings(const StreamInputs& streams) const;

 private:
  enum class Phase : std::uint8_t { kWaiting, kAveraging, kMoving, kDone };

  void KnowTimes(TimeNs t_ns);
  std::optional<CrtkCommand> StartUp(const CycleInputs& inputs);
  std::optional<CrtkCommand> Ending(const CycleInputs& inputs);
  bool PersonResumed(const CycleInputs& inputs);
  void Fault(const CycleInputs& inputs, CycleOutputs& outputs);
  void Average(const CycleInputs& inputs, const ControllerCommand& command, bool new_tip);
  void StartPath();
  void MakePath();
  ControllerInputs Wish(const CycleInputs& inputs, bool moves, bool new_tip, double dt_s,
                        CycleOutputs& outputs);
  void GoToGoal(const CycleInputs& inputs, double dt_s);
  void Command(const ControllerCommand& command, double dt_s, CycleOutputs& outputs);
  void HoldStill(const CycleInputs& inputs, CycleOutputs& outputs);

  const Session session_;
  bool wait_;
  InstrumentController controller_;
  ControllerCommand command_;
  std::optional<TipPath> path_;
  Phase phase_ = Phase::kWaiting;
  bool enabled_once_ = false;
  TimeNs t_ns_ = 0;             // of the last cycle
  TimeNs clear_since_ns_ = 0;   // since when no cause held; 0: one holds
  TimeNs average_from_ns_ = 0;  // of the start
  Eigen::Vector3d sum_p_ = Eigen::Vector3d::Zero(), sum_d_ = Eigen::Vector3d::Zero();
  int averaged_ = 0;
  double tip_time_sd_s_ = 0.0, em0_time_sd_s_ = 0.0;  // as the controller was told
  TimeNs tip_t_ns_ = 0;                               // of the last tip that a cycle had
  std::optional<Eigen::Vector3d> p_goal_;             // the path's, last
  Eigen::Vector3d p_RE_known_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> p_target_;           // of the controller, not yet limited
  Eigen::Vector3d p_last_ = Eigen::Vector3d::Zero();  // commanded
  Eigen::Vector3d v_last_m_s_ = Eigen::Vector3d::Zero();
  JerkFilter jerk_;
  bool moving_ = false;                    // p_last_ is a set-point of motion
  bool wrist_waits_ = false;               // in the last cycle, by the supervisor
  std::optional<Eigen::Vector3d> p_held_;  // the wrist as measured when the hold began
  TimeNs asked_ns_ = 0;                    // when the robot was last told to change its state
  bool asked_home_ = false;
  bool fault_ = false,
       paused_by_fault_ = false;  // of the supervisor; and the robot then was paused
};

}  // namespace flextip::live
