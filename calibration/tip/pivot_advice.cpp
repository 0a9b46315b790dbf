#include "calibration/tip/pivot_advice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kTurn_rad = 0.7;

Eigen::Matrix3d MeanRotation(const std::vector<PivotPose>& poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PivotPose& pose : poses) sum += pose.T_RB.R;
  const Svd svd(sum);
  Eigen::Matrix3d U = svd.U;
  if ((U * svd.V.transpose()).determinant() < 0) U.col(2) *= -1.0;
  return U * svd.V.transpose();
}

/// Root of the trace of the tip's covariance; infinite where it is not known.
double TipSd(const Matrix6d& H) {
  const Ldlt ldlt(H);
  if (!ldlt.Succeeded() || (ldlt.Pivots().array() <= 0).any()) {
    return std::numeric_limits<double>::infinity();
  }
  const Matrix6d C = ldlt.Inverse();
  return std::sqrt(C.topLeftCorner<3, 3>().trace());
}

}  // namespace

PivotAdvice AdvisePivot(const std::vector<PivotPose>& poses, const Matrix6d& H,
                        const Eigen::Matrix3d& S, const Eigen::Matrix3d& turn_axes_B) {
  const Eigen::Matrix3d R_mean = MeanRotation(poses), W = S.inverse();
  const int count = std::max(4, static_cast<int>(poses.size()) / 4);
  std::vector<Eigen::Vector3d> axes;
  axes.reserve(6);
  for (int i = 0; i < 3; ++i) axes.emplace_back(Eigen::Vector3d::Unit(i));
  for (int i = 0; i < 3; ++i) axes.emplace_back(turn_axes_B.col(i));
  PivotAdvice best;
  best.sd_after_m = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& axis : axes) {
    Matrix6d more = H;
    for (const double angle : {-kTurn_rad, kTurn_rad}) {
      Eigen::Matrix<double, 3, 6> J;
      J << R_mean * ExpRotation(angle * axis), -Eigen::Matrix3d::Identity();
      more += 0.5 * count * J.transpose() * W * J;
    }
    // B's own axes come first and are easier to say: another has to be better by one per cent.
    const double sd = TipSd(more);
    if (sd < 0.99 * best.sd_after_m) best = {axis, kTurn_rad, count, sd};
  }
  return best;
}

}  // namespace flextip
