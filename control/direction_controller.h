// The tip's place and direction together, as far as the wrist's three axes allow (end of the
// thesis's 3.5).
#pragma once

#include <Eigen/Dense>

#include "control/controller.h"
#include "estimation/shaft_model.h"
#include "estimation/shaft_rod.h"

namespace flextip {

using Matrix63d = Eigen::Matrix<double, 6, 3>;

/// How the tip moves with the wrist.
struct TipJacobians {
  Eigen::Matrix3d position = Eigen::Matrix3d::Zero();   ///< d p_RE / d p_RW
  Eigen::Matrix3d direction = Eigen::Matrix3d::Zero();  ///< d d_RE / d p_RW (rad/m), rank 2 at most
};

/// Returns the Jacobians by the exact rod's derivatives; the load follows the tip by `stiffness` =
/// df/dp (N/m).
TipJacobians TipJacobiansOf(const ShaftRodState& rod, const Eigen::Matrix3d& stiffness);

/// Returns the direction's Jacobian as the thesis proposes (3.5): the shape stays, and turns with
/// the chord from wrist to tip. `J_tip_wrist` of any model; m, in R.
Eigen::Matrix3d DirectionByRegistration(const Eigen::Matrix3d& J_tip_wrist,
                                        const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                                        const Eigen::Vector3d& d_RE);

enum class DirectionPriority {
  kWeighted,       ///< one compromise, by the two tolerances
  kPositionFirst,  ///< the position but along `free_axis`; the direction in the rest
};

struct DirectionOptions {
  DirectionPriority priority = DirectionPriority::kWeighted;
  double position_tolerance_m = 0.001;   ///< kWeighted: an error of this ...
  double direction_tolerance_rad = 0.1;  ///< ... weighs as much as one of that
  double gain = 1.0;
  double max_step_m = 0.01;
  double max_tissue_gain = 1.7;      ///< as in ControllerOptions
  double min_singular_value = 0.05;  ///< kPositionFirst: of J_tip_wrist; damped below
};

/// One cycle's input. Everything in R.
struct DirectionInput {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();   ///< the tip, measured or estimated
  Eigen::Vector3d d_RE = Eigen::Vector3d::UnitX();  ///< its direction, any length
  Eigen::Vector3d p_RE_desired = Eigen::Vector3d::Zero();
  Eigen::Vector3d d_RE_desired = Eigen::Vector3d::UnitX();
  /// kPositionFirst: the position along this (any length) does not matter; zero: all of it does.
  Eigen::Vector3d free_axis = Eigen::Vector3d::Zero();
  ShaftModel model;
};

struct DirectionOutput {
  ControlStatus status = ControlStatus::kNoModel;
  bool step_limited = false;
  bool damped = false;
  /// How many of the direction's two parts the wrist can still move, given the position's share.
  int direction_freedoms = 0;
  Eigen::Vector3d p_RW_command = Eigen::Vector3d::Zero();
  TipJacobians J;
  double position_left_m = 0.0;     ///< of the error, after this step by the model
  double direction_left_rad = 0.0;  ///< likewise
};

/// One controller. A step takes and returns fixed-size data, allocates nothing and is bounded.
///
/// Place and direction are five conditions, the pinned wrist has three axes: with all of the place
/// held nothing is left for the direction. Possible are a compromise, or the direction in exchange
/// for a part of the place that does not matter.
class DirectionController {
 public:
  explicit DirectionController(const DirectionOptions& options) : options_(options) {}

  void SetGain(double gain) { options_.gain = gain; }

  DirectionOutput Step(const DirectionInput& input);

  void VisitState(StateText& state) {
    state(wrist_);
    state(rod_);
  }

 private:
  Eigen::Vector3d Weighted(const Eigen::Vector3d& dp, const Eigen::Vector3d& dd,
                           DirectionOutput& output) const;
  Eigen::Vector3d PositionFirst(const Eigen::Vector3d& dp, const Eigen::Vector3d& dd,
                                const DirectionInput& input, DirectionOutput& output) const;

  DirectionOptions options_;
  HeldWrist wrist_;
  ShaftRod rod_;
};

}  // namespace flextip
