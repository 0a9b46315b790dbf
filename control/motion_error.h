// The difference between a Jacobian controller's motion and the desired motion: the measures of the
// thesis's chapter 2, fast enough for every cycle of a control loop.
//
// J is the true Jacobian, J_hat the Jacobian that the controller inverts, k its gain (2.1). The tip
// moves by A dx_d with A = k J J_hat^-1 (2.2), and G = I - A maps the desired motion to the rest
// (2.5). J and J_hat are N x N with N = 2 or 3, both from the same joints or wrist (any unit) to
// the same frame. Directions are unit vectors of dx_d in that frame; their sign means nothing.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <limits>
#include <numbers>

namespace flextip {

enum class MotionErrorStatus : std::uint8_t {
  kOk,
  /// J is singular to working precision: some motions are not made at all and have no angle.
  /// phi_max is the supremum over those that are, p_phi where it is approached.
  kSingularTruth,
  kSingularEstimate,  ///< J_hat is singular to working precision: no step, nothing is bounded
  kBadInput,          ///< not finite, or the gain is not positive
  kNotConverged,      ///< bounded work was not enough to prove that phi_max is the largest
};
const char* Name(MotionErrorStatus status);

/// The norm of the error after a step. Where it is not usable, `norm` is infinite.
template <int N>
struct StepError {
  MotionErrorStatus status = MotionErrorStatus::kBadInput;
  double norm = std::numeric_limits<double>::infinity();  ///< ||G|| (2.6); below 1: converges
  Eigen::Matrix<double, N, 1> v_sigma = Eigen::Matrix<double, N, 1>::Zero();  ///< its direction
  double phi_hat_max_rad = std::numbers::pi;  ///< bound (2.10) on phi_max, for this gain

  bool IsUsable() const { return status == MotionErrorStatus::kOk; }
};

/// The largest angle between desired and actual motion. Where it is not usable, pi.
template <int N>
struct AngleError {
  MotionErrorStatus status = MotionErrorStatus::kBadInput;
  double phi_max_rad = std::numbers::pi;  ///< |phi_max| (2.9), 0 to pi
  Eigen::Matrix<double, N, 1> p_phi = Eigen::Matrix<double, N, 1>::Zero();  ///< its direction

  bool IsUsable() const {
    return status == MotionErrorStatus::kOk || status == MotionErrorStatus::kSingularTruth;
  }
};

/// Finds ||G||, v_sigma and phi_hat_max, (2.5), (2.6), (2.10). The bound is pi as soon as ||G||
/// exceeds 1.
StepError<2> FindStepError(const Eigen::Matrix2d& J, const Eigen::Matrix2d& J_hat,
                           double gain = 1.0) noexcept;
StepError<3> FindStepError(const Eigen::Matrix3d& J, const Eigen::Matrix3d& J_hat,
                           double gain = 1.0) noexcept;

/// Finds the exact phi_max and p_phi of (2.9), for any positive gain: an angle does not depend on
/// the gain. In the plane in closed form. In space by a search along a line that is proved to find
/// the largest of several maxima to 1e-10 rad (within 1e-4 rad of pi: 2e-14 of the cosine), plus
/// the rounding of J_hat's inverse (1e-16 times its condition).
AngleError<2> FindLargestAngle(const Eigen::Matrix2d& J, const Eigen::Matrix2d& J_hat) noexcept;
AngleError<3> FindLargestAngle(const Eigen::Matrix3d& J, const Eigen::Matrix3d& J_hat) noexcept;

}  // namespace flextip
