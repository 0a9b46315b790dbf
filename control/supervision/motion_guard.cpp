#include "control/supervision/motion_guard.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/motion_error.h"
#include "control/wrist_step.h"

namespace flextip {
namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;

}  // namespace

double MotionGuard::AngleAt(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                            const Eigen::Vector3d& p_RW, const Vector9d& shift) {
  ShaftModel model = estimate.model;
  model.p_RP += shift.segment<3>(3);
  model.f_tip_N += shift.tail<3>();
  const ShaftRodState rod = rod_.Solve(RodOf(model, p_RW + shift.head<3>()));
  if (!rod.IsUsable()) return std::numbers::pi;
  const Eigen::Matrix3d C = rod.dp_RE.rightCols<3>();
  const Eigen::Matrix3d K = TrustedStiffness(model.tissue_stiffness_N_m, C, max_tissue_gain_);
  const Eigen::Matrix3d J =
      (Eigen::Matrix3d::Identity() - C * K).inverse() * rod.dp_RE.leftCols<3>();
  return FindLargestAngle(J, J_hat).phi_max_rad;
}

double MotionGuard::Update(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                           const Eigen::Vector3d& p_RW) {
  const bool fitted =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  if (!fitted || !J_hat.allFinite() || !estimate.covariance.allFinite()) {
    seen_rad_.fill(0.0);
    return 0.0;
  }
  // The axis through the ellipsoid's surface in the direction of one parameter: a column of the
  // covariance over that parameter's deviation.
  const double sd = std::sqrt(std::max(0.0, estimate.covariance(axis_, axis_)));
  Vector9d shift = Vector9d::Zero();
  if (sd > 0.0) shift = deviations_ / sd * estimate.covariance.col(axis_);
  seen_rad_[static_cast<std::size_t>(axis_)] =
      std::max(AngleAt(J_hat, estimate, p_RW, shift), AngleAt(J_hat, estimate, p_RW, -shift));
  axis_ = (axis_ + 1) % kAxes;
  return *std::max_element(seen_rad_.begin(), seen_rad_.end());
}

}  // namespace flextip
