#include "calibration/uncertainty/projection_uncertainty.h"

#include <algorithm>
#include <limits>

#include "calibration/camera/projection_derivative.h"
#include "core/linear_algebra.h"
#include "core/matrix_types.h"
#include "core/median.h"
#include "core/rotation.h"
#include "vision/camera_model.h"

namespace flextip {
namespace {

// (w, t) of the world in the camera as one view's (dw, dp) has it.
Matrix6d WorldOfPose(const Pose& T_CB) {
  Matrix6d L = Matrix6d::Identity();
  L.bottomLeftCorner<3, 3>() = Skew(T_CB.p);
  return L;
}

double MeanFinite(const Eigen::MatrixXd& values) {
  double sum = 0.0;
  int count = 0;
  for (const double v : values.reshaped()) {
    if (!std::isfinite(v)) continue;
    sum += v;
    ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::optional<ProjectionUncertainty> ProjectionUncertainty::Of(const CameraSolution& solution) {
  const Eigen::MatrixXd all = solution.Covariance();
  if (all.size() == 0) return {};
  ProjectionUncertainty u;
  u.camera_ = solution.camera;
  u.warp_ = solution.warp;
  u.noise_px_ = solution.noise_px;
  u.intrinsics_ = solution.IntrinsicsCount();
  u.warps_ = solution.WarpCount();
  u.views_ = static_cast<int>(solution.views.size());
  const int common = u.intrinsics_ + u.warps_;
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(common + 6, all.rows());
  M.topLeftCorner(common, common).setIdentity();
  for (std::size_t v = 0; v < solution.views.size(); ++v) {
    M.block<6, 6>(common, solution.ViewStart(v)) = WorldOfPose(solution.views[v].T_CB) / u.views_;
  }
  u.covariance_ = M * all * M.transpose();
  return u;
}

std::optional<ProjectionUncertainty> ProjectionUncertainty::Of(const StereoSolution& solution,
                                                               int eye) {
  const Eigen::MatrixXd all = solution.Covariance();
  if (all.size() == 0) return {};
  ProjectionUncertainty u;
  u.camera_ = solution.cameras[eye];
  u.warp_ = solution.warp;
  u.noise_px_ = solution.noise_px;
  u.intrinsics_ = solution.IntrinsicsCount(eye);
  u.warps_ = solution.WarpCount();
  u.views_ = static_cast<int>(solution.views.size());
  const int common = u.intrinsics_ + u.warps_, pair = solution.PairStart();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(common + 6, all.rows());
  M.block(0, eye == 0 ? 0 : solution.IntrinsicsCount(0), u.intrinsics_, u.intrinsics_)
      .setIdentity();
  M.block(u.intrinsics_, pair + 6, u.warps_, u.warps_).setIdentity();
  for (std::size_t v = 0; v < solution.views.size(); ++v) {
    const StereoView& view = solution.views[v];
    const Matrix6d L = WorldOfPose(solution.T_CB(view, eye)) / u.views_;
    if (eye == 0) {
      M.block<6, 6>(common, solution.ViewStart(v)) = L;
      continue;
    }
    // T_C1B = T_C0C1^-1 T_C0B: its step from those of the two.
    const Eigen::Matrix3d R_C1C0 = solution.T_C0C1.R.transpose();
    Matrix6d by_view = Matrix6d::Zero(), by_pair;
    by_view.topLeftCorner<3, 3>() = by_view.bottomRightCorner<3, 3>() = R_C1C0;
    by_pair = -by_view;
    by_pair.bottomLeftCorner<3, 3>() = R_C1C0 * Skew(view.T_C0B.p - solution.T_C0C1.p);
    M.block<6, 6>(common, solution.ViewStart(v)) = L * by_view;
    M.block<6, 6>(common, pair) += L * by_pair;
  }
  u.covariance_ = M * all * M.transpose();
  return u;
}

std::optional<Eigen::Matrix2d> ProjectionUncertainty::CovariancePx(const Eigen::Vector2d& px,
                                                                   double depth_m) const {
  const auto ray = CameraModel(camera_).Unproject(px);
  if (!ray || ray->z() < 1e-3) return {};
  const bool infinite = !std::isfinite(depth_m);
  return CovarianceOfPoint(*ray / ray->z() * (infinite ? 1.0 : depth_m), infinite);
}

Eigen::Matrix2d ProjectionUncertainty::CovarianceOfPoint(const Eigen::Vector3d& x_C,
                                                         bool infinite) const {
  const ProjectionDerivative d = DifferentiateProjection(camera_, x_C);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, covariance_.cols());
  J.leftCols(intrinsics_) = d.by_intrinsics;
  J.middleCols<3>(intrinsics_ + warps_) = -d.by_point * Skew(x_C);
  if (!infinite) J.rightCols<3>() = d.by_point;
  return J * covariance_ * J.transpose();
}

ProjectionUncertainty ProjectionUncertainty::WithView(
    const Pose& T_CB, const std::vector<Eigen::Vector3d>& x_B) const {
  // The view's normal equations; its pose, given the lens and the warp, is K (lens, warp) plus
  // noise of its own, and what is left tells of lens and warp.
  const int common = intrinsics_ + warps_;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(common, common), B = Eigen::MatrixXd::Zero(6, common);
  Matrix6d P = Matrix6d::Zero();
  for (const Eigen::Vector3d& x : x_B) {
    const Eigen::Vector3d turned = T_CB.R * warp_.Bent(x);
    const ProjectionDerivative d = DifferentiateProjection(camera_, turned + T_CB.p);
    Eigen::MatrixXd J(2, common);
    J.leftCols(intrinsics_) = d.by_intrinsics;
    if (warps_ > 0) {
      J.rightCols<2>() = d.by_point * T_CB.R.col(2) * warp_.Shape(x).transpose();
    }
    Eigen::Matrix<double, 2, 6> J_pose;
    J_pose << -d.by_point * Skew(turned), d.by_point;
    A += J.transpose() * J;
    B += J_pose.transpose() * J;
    P += J_pose.transpose() * J_pose;
  }
  const Ldlt of_pose(P);
  const Eigen::MatrixXd K = -of_pose.Solve(B);
  const double noise2 = noise_px_ * noise_px_;
  const Eigen::MatrixXd S = (A + B.transpose() * K) / noise2;

  // The information S, of (lens, warp), added.
  const Eigen::MatrixXd C_common = covariance_.leftCols(common);
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(common, common);
  const Eigen::MatrixXd gain = Lu(I + S * C_common.topRows(common)).Solve(S * C_common.transpose());
  const Eigen::MatrixXd after = covariance_ - C_common * gain;

  // The mean over one board more.
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(common + 6, common + 6);
  const Matrix6d L = WorldOfPose(T_CB) / (views_ + 1);
  M.bottomRightCorner<6, 6>() *= static_cast<double>(views_) / (views_ + 1);
  M.bottomLeftCorner(6, common) = L * K;
  ProjectionUncertainty u = *this;
  u.views_ = views_ + 1;
  u.covariance_ = M * after * M.transpose();
  u.covariance_.bottomRightCorner<6, 6>() += noise2 * L * of_pose.Inverse() * L.transpose();
  u.covariance_ = (0.5 * (u.covariance_ + u.covariance_.transpose())).eval();
  return u;
}

double WorstSd(const Eigen::Matrix2d& covariance) {
  return std::sqrt(std::max(0.0, SymmetricEigenvalues(covariance)[1]));
}

double UncertaintyMap::MeanPx() const { return MeanFinite(sd_px); }

double UncertaintyMap::LargestPx() const {
  double largest = 0.0;
  for (const double v : sd_px.reshaped()) {
    if (std::isfinite(v)) largest = std::max(largest, v);
  }
  return largest;
}

double UncertaintyMap::CentrePx() const { return sd_px(sd_px.rows() / 2, sd_px.cols() / 2); }

double UncertaintyMap::MeanMm() const { return MeanFinite(sd_mm); }

UncertaintyMap MapUncertainty(const ProjectionUncertainty& uncertainty, double depth_m, int columns,
                              int rows) {
  const CameraCalibration& camera = uncertainty.Camera();
  const double absent = std::numeric_limits<double>::quiet_NaN();
  UncertaintyMap map;
  map.depth_m = depth_m;
  for (int i = 0; i < columns; ++i) map.x_px.push_back(i * (camera.width_px - 1.0) / (columns - 1));
  for (int i = 0; i < rows; ++i) map.y_px.push_back(i * (camera.height_px - 1.0) / (rows - 1));
  map.sd_px.setConstant(rows, columns, absent);
  const bool finite = std::isfinite(depth_m);
  if (finite) map.sd_mm.setConstant(rows, columns, absent);
  const CameraModel model(camera);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d px(map.x_px[column], map.y_px[row]);
      const auto ray = model.Unproject(px);
      if (!ray || ray->z() < 1e-3) continue;
      const Eigen::Vector3d x_C = *ray / ray->z() * (finite ? depth_m : 1.0);
      const Eigen::Matrix2d covariance = uncertainty.CovarianceOfPoint(x_C, !finite);
      map.sd_px(row, column) = WorstSd(covariance);
      if (!finite) continue;
      const Eigen::Matrix2d across =
          DifferentiateProjection(camera, x_C).by_point.leftCols<2>().inverse();
      map.sd_mm(row, column) = 1e3 * WorstSd(across * covariance * across.transpose());
    }
  }
  return map;
}

double MedianBoardDepth(const CameraSolution& solution) {
  const Eigen::Vector3d centre_B(solution.warp.centre_m.x(), solution.warp.centre_m.y(), 0);
  std::vector<double> depths;
  for (const SolvedView& view : solution.views) depths.push_back((view.T_CB * centre_B).z());
  return Median(depths);
}

double MedianBoardDepth(const StereoSolution& solution, int eye) {
  const Eigen::Vector3d centre_B(solution.warp.centre_m.x(), solution.warp.centre_m.y(), 0);
  std::vector<double> depths;
  for (const StereoView& view : solution.views) {
    depths.push_back((solution.T_CB(view, eye) * centre_B).z());
  }
  return Median(depths);
}

}  // namespace flextip
