// The worst angle between wanted and actual motion (chapter 2), watched while the robot moves.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <optional>

#include "control/controller.h"
#include "estimation/shaft_estimator.h"

namespace flextip {

/// Follows what FindWorstMotion finds, at the cost of two rods an axis of the ellipsoid in which
/// wrist, port and tip force lie: all nine axes in a cycle up to 30 Hz, fewer of faster cycles. No
/// tip force is believed that a shaft is not used for. Fixed size, allocates nothing.
class MotionGuard {
 public:
  /// Takes the ellipsoid's half axes in standard deviations, how far tissue is trusted, and the
  /// cycles' rate.
  MotionGuard(double deviations, double max_tissue_gain, double rate_hz);

  /// Solves the rods of some of the axes anew. An estimate without a rod forgets all.
  void Update(const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW);

  /// Returns the largest angle of (2.9) (rad) between what the controller's `J_hat` (d tip / d
  /// wrist) is asked for and what the rods do, for the worst motion. pi where a rod has buckled or
  /// `J_hat` is not finite; zero before Update.
  double WorstAngle(const Eigen::Matrix3d& J_hat) const;

  /// Returns the exact Jacobian (d tip / d wrist), the mean over the rods; empty before Update.
  std::optional<Eigen::Matrix3d> Jacobian() const;

  /// Returns the largest angle (rad) between the tip's motion `dp_RE_wanted` and the one that the
  /// wrist's step `dp_RW` makes, by the rods of the last calls of Update: at most WorstAngle of
  /// the Jacobian that the step is by. pi where a rod has buckled; zero before Update.
  double StepAngle(const Eigen::Vector3d& dp_RE_wanted, const Eigen::Vector3d& dp_RW) const;

  void VisitState(StateText& state) {
    state(ends_);
    state(axis_);
  }

 private:
  static constexpr int kAxes = 9;
  /// The exact Jacobian at one end of an axis, and the rod there, from which the next one starts.
  struct End {
    enum class State : std::uint8_t { kUnknown, kBuckled, kFound } state = State::kUnknown;
    Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
    ShaftRod rod;
    void VisitState(StateText& s) {
      s(state);
      s(J);
      s(rod);
    }
  };
  void LookAt(const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW,
              const Eigen::Matrix<double, 9, 1>& shift, End& end);

  double deviations_, max_tissue_gain_;
  int axes_a_cycle_;
  std::array<End, 2 * kAxes> ends_;
  int axis_ = 0;
};

}  // namespace flextip
