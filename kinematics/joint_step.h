// The thesis's controller in joint space (3.4): theta_d = theta + (J_i J_r)^-1 (p_desired - p_t),
// for an instrument Jacobian J_i of any shaft model and any arm's J_r.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

#include "core/linear_algebra.h"

namespace flextip {

enum class JointStepStatus : std::uint8_t {
  kOk,
  kDamped,    ///< near singular: the step is shortened along the weak directions
  kBadInput,  ///< not finite: the joints hold still
};

template <int N>
struct JointStepInput {
  Eigen::Matrix<double, N, 1> theta = Eigen::Matrix<double, N, 1>::Zero();               ///< rad
  Eigen::Matrix<double, N, 1> p_tip = Eigen::Matrix<double, N, 1>::Zero();               ///< m
  Eigen::Matrix<double, N, 1> p_tip_desired = Eigen::Matrix<double, N, 1>::Zero();       ///< m
  Eigen::Matrix<double, N, N> J_tip_wrist = Eigen::Matrix<double, N, N>::Identity();     ///< J_i
  Eigen::Matrix<double, N, N> J_wrist_joints = Eigen::Matrix<double, N, N>::Identity();  ///< J_r
  /// Singular values of J_i J_r (m/rad) below this are damped; must be positive.
  double min_singular_value_m = 0.005;
};

template <int N>
struct JointStepResult {
  JointStepStatus status = JointStepStatus::kBadInput;
  Eigen::Matrix<double, N, 1> theta_desired = Eigen::Matrix<double, N, 1>::Zero();  ///< rad
  double smallest_singular_value_m = 0.0;
};

/// Makes one step of (3.4). Along a direction with singular value s below the limit e, the inverse
/// is s / e^2 instead of 1 / s: continuous at e and zero at s = 0. So the joints never move by more
/// than |p_desired - p_t| / e. All vectors of one call are in the same frame.
template <int N>
JointStepResult<N> JointStep(const JointStepInput<N>& input) noexcept {
  JointStepResult<N> result;
  result.theta_desired = input.theta;
  const Eigen::Matrix<double, N, N> J = input.J_tip_wrist * input.J_wrist_joints;
  const Eigen::Matrix<double, N, 1> move = input.p_tip_desired - input.p_tip;
  const double limit = input.min_singular_value_m;
  if (!J.allFinite() || !move.allFinite() || !input.theta.allFinite() || !(limit > 0)) {
    return result;
  }
  const Svd<N> svd(J);
  const auto& s = svd.sigma;
  Eigen::Matrix<double, N, 1> inverse;
  for (int i = 0; i < N; ++i) inverse[i] = s[i] >= limit ? 1.0 / s[i] : s[i] / (limit * limit);
  result.theta_desired += svd.V * inverse.cwiseProduct(svd.U.transpose() * move);
  result.smallest_singular_value_m = s[N - 1];
  result.status = s[N - 1] < limit ? JointStepStatus::kDamped : JointStepStatus::kOk;
  return result;
}

}  // namespace flextip
