// The Jacobian controllers: thesis 5.2.2 and two with the exact rod.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string_view>

#include "estimation/shaft_model.h"
#include "estimation/shaft_rod.h"

namespace flextip {

enum class ControllerKind {
  kStraightCalculate,  ///< lever Jacobian (3.27), tip calculated from it
  kStraightTrack,      ///< lever Jacobian, tip measured
  kFlexCalculate,      ///< thesis's beam, tip calculated from it
  kFlexTrack,          ///< thesis's beam, tip measured
  kRodCalculate,       ///< exact rod, tip calculated from it
  kRodTrack,           ///< exact rod, tip measured
};
inline constexpr int kControllerKinds = 6;

/// Returns "straight-calculate", "straight-track", ... as in scenario files and summaries.
const char* Name(ControllerKind kind);
/// Returns the kind of that name; empty for an unknown name.
std::optional<ControllerKind> ControllerKindNamed(std::string_view name);
bool UsesTipMeasurement(ControllerKind kind);

struct ControllerOptions {
  ControllerKind kind = ControllerKind::kRodTrack;
  BeamLoadLaw beam_load_law = BeamLoadLaw::kTipForce;
  double gain = 1.0;             ///< k of (2.1)
  double max_step_m = 0.01;      ///< bound on the wrist's motion in one step
  double max_tissue_gain = 1.7;  ///< of the loop, should tissue that was felt let go (below 2)
  /// In which a correction is made where steps come faster: a video picture's time. 0: at once.
  double correction_s = 1.0 / 30.0;
  double rate_hz = 0.0;  ///< of the steps; 0: seldom, so that each makes its whole correction
  double min_singular_value = 0.05;  ///< of J_tip_wrist; below it the inverse is damped
};

/// Returns the part of a correction that one step makes, in (0, 1].
double CorrectionPart(const ControllerOptions& options);

/// What was sent to the robot in the last cycle, and the goal of then. In R.
struct SentCommand {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero(), p_RE_desired = Eigen::Vector3d::Zero();

  void VisitState(StateText& state) {
    state(p_RW);
    state(p_RE_desired);
  }
};

/// One cycle's input. Everything in R.
struct ControlInput {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();  ///< as measured
  Eigen::Vector3d p_RE_desired = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_RE_measured = Eigen::Vector3d::Zero();
  bool tip_measured = false;  ///< p_RE_measured is valid in this cycle
  ShaftModel model;
  /// Where there, and steps are fast, the command goes on from it: with the goal's motion at once,
  /// with the correction by CorrectionPart. Without, the step makes its whole correction.
  std::optional<SentCommand> last;
};

enum class ControlStatus {
  kOk,
  kBadInput,         ///< a position is not finite or absurdly far, or an option has no meaning:
                     ///< the wrist holds still, where it was last known
  kNoTip,            ///< the kind needs a measured tip and there is none: the wrist holds still
  kNoModel,          ///< the shaft model cannot be evaluated (port out of reach, a number that no
                     ///< shaft has): holds still
  kStraightInstead,  ///< flexion not observable now: the straight shaft's Jacobian was used
  kNoGoal,           ///< nothing is wanted of the tip: the wrist holds still
  kNoWrist,          ///< the wrist was not measured: there is no command
};

const char* Name(ControlStatus status);

struct ControlOutput {
  ControlStatus status = ControlStatus::kNoModel;
  bool step_limited = false;  ///< shortened to max_step_m, or to keep its distance from the port
  bool damped = false;        ///< the Jacobian was near singular
  Eigen::Vector3d p_RW_command = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_RE_used = Eigen::Vector3d::Zero();    ///< the tip the step started from
  Eigen::Matrix3d J_tip_wrist = Eigen::Matrix3d::Zero();  ///< the Jacobian the step used
  double smallest_singular_value = 0.0;
};

/// The wrist where it was last measured: a controller holds it there where it is not known.
class HeldWrist {
 public:
  /// Returns `p_RW` (m, in R) where it is finite, else the last that was; zero before there was
  /// one.
  const Eigen::Vector3d& Hold(const Eigen::Vector3d& p_RW) {
    if (p_RW.allFinite()) p_RW_ = p_RW;
    return p_RW_;
  }

  void VisitState(StateText& state) { state(p_RW_); }

 private:
  Eigen::Vector3d p_RW_ = Eigen::Vector3d::Zero();
};

/// One controller. A step takes and returns fixed-size data, allocates nothing and is bounded: one
/// rod at most. Whatever comes in, the command is finite and at most `max_step_m` from the wrist.
class TipController {
 public:
  explicit TipController(const ControllerOptions& options) : options_(options) {}

  ControlOutput Step(const ControlInput& input);

  const ControllerOptions& Options() const { return options_; }
  void SetGain(double gain) { options_.gain = gain; }

  void VisitState(StateText& state) {
    state(wrist_);
    state(rod_);
  }

 private:
  ControllerOptions options_;
  HeldWrist wrist_;
  ShaftRod rod_;  // keeps the last equilibrium as the next step's starting point
};

}  // namespace flextip
