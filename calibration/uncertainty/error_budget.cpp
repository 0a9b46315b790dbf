#include "calibration/uncertainty/error_budget.h"

#include <algorithm>
#include <cmath>

#include "calibration/camera/projection_derivative.h"
#include "core/linear_algebra.h"
#include "core/matrix_types.h"
#include "core/rotation.h"
#include "kinematics/tip_bending.h"
#include "vision/tags/collar_pose.h"

namespace flextip {
namespace {

const CollarTag* TagOf(const TagCollar& collar, int id) {
  const auto tag = std::find_if(collar.tags.begin(), collar.tags.end(),
                                [id](const CollarTag& t) { return t.id == id; });
  return tag == collar.tags.end() ? nullptr : &*tag;
}

// d(p_CE)/d(intrinsics) of the least-squares pose while the corners stay where they were seen.
Eigen::MatrixXd PositionByLens(const CameraCalibration& camera, const TagCollar& collar,
                               const std::vector<TagDetection>& tags, const Pose& T_CE) {
  const auto n = static_cast<Eigen::Index>(4 + camera.distortion_coefficients.size());
  Matrix6d by_pose = Matrix6d::Zero();
  Eigen::MatrixXd by_lens = Eigen::MatrixXd::Zero(6, n);
  for (const TagDetection& seen : tags) {
    const CollarTag* tag = TagOf(collar, seen.id);
    if (!tag) continue;
    for (const Eigen::Vector3d& x_E : CornersInE(*tag)) {
      const Eigen::Vector3d turned = T_CE.R * x_E;
      const ProjectionDerivative d = DifferentiateProjection(camera, turned + T_CE.p);
      Eigen::Matrix<double, 2, 6> J;
      J << -d.by_point * Skew(turned), d.by_point;
      by_pose += J.transpose() * J;
      by_lens += J.transpose() * d.by_intrinsics;
    }
  }
  return -Ldlt(by_pose).Solve(by_lens).bottomRows<3>();
}

void AddBending(const TipBending& bending, const Pose& T_RE, double free_length_m,
                TipBudget& budget) {
  if (!(bending.stiffness_Nm2 > 0)) return;
  const FreeEnd end{free_length_m, bending.stiffness_Nm2, bending.weight_N_m};
  budget.bend_R = BendFreeEnd(end, bending.f_R, T_RE).p - T_RE.p;
  const Eigen::Matrix3d square = budget.bend_R * budget.bend_R.transpose();
  budget.parts.push_back({"bending", square, !bending.corrected});
  if (bending.corrected) {
    const Eigen::Vector3d d = T_RE.R.col(0);
    const double sd_m = FreeEndCompliance(end) * bending.force_noise_N;
    budget.parts.push_back(
        {"load", sd_m * sd_m * (Eigen::Matrix3d::Identity() - d * d.transpose()), true});
  }
  if (!(bending.stiffness_sd_Nm2 > 0)) return;
  const double relative = bending.stiffness_sd_Nm2 / bending.stiffness_Nm2;
  budget.parts.push_back({"stiffness", relative * relative * square, bending.corrected});
}

}  // namespace

Eigen::Matrix3d TipBudget::TotalCovariance() const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const BudgetPart& part : parts) {
    if (part.in_total) sum += part.covariance_R;
  }
  return sum;
}

DepthAndAcross SplitByDepth(const Eigen::Matrix3d& covariance_R, const Eigen::Vector3d& depth_R) {
  const Eigen::Matrix<double, 3, 2> across = NormalBasis(depth_R);
  const Eigen::Matrix2d plane = across.transpose() * covariance_R * across;
  return {.depth_m = std::sqrt(std::max(0.0, depth_R.dot(covariance_R * depth_R))),
          .across_m = std::sqrt(std::max(0.0, SymmetricEigenvalues(plane)[1]))};
}

std::optional<TipBudget> BudgetOfTip(const CameraCalibration& camera, const TagCollar& collar,
                                     const std::vector<TagDetection>& tags,
                                     const ChainCovariance& chain,
                                     const std::optional<TipBending>& bending) {
  const CollarPose pose = EstimateCollarPose(CameraModel(camera), collar, tags);
  if (!pose.IsUsable()) return {};
  const Pose T_RE = camera.T_RC * pose.T_CE;
  const Eigen::Matrix3d& R_RC = camera.T_RC.R;
  TipBudget budget;
  budget.p_RE = T_RE.p;
  budget.depth_R = (T_RE.p - camera.T_RC.p).normalized();
  budget.parts.push_back(
      {"pixels", R_RC * pose.covariance.bottomRightCorner<3, 3>() * R_RC.transpose(), true});
  if (chain.lens.size() > 0) {
    const Eigen::MatrixXd J = R_RC * PositionByLens(camera, collar, tags, pose.T_CE);
    budget.parts.push_back({"lens", J * chain.lens * J.transpose(), true});
  }
  if (chain.hand_eye.size() > 0) {
    Eigen::Matrix<double, 3, 6> J;
    J << -Skew(T_RE.p - camera.T_RC.p), Eigen::Matrix3d::Identity();
    budget.parts.push_back({"hand-eye", J * chain.hand_eye * J.transpose(), true});
  }
  if (chain.tip_offset.size() > 0) {
    budget.parts.push_back({"tip offset", T_RE.R * chain.tip_offset * T_RE.R.transpose(), true});
  }
  if (bending) AddBending(*bending, T_RE, FreeLength(collar), budget);
  return budget;
}

}  // namespace flextip
