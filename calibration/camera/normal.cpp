#include "calibration/camera/normal.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "calibration/camera/corner_error.h"
#include "calibration/camera/projection_derivative.h"
#include "calibration/camera/shape_elimination.h"
#include "core/matrix_types.h"

namespace flextip {
namespace {

struct Sums {
  ShapeElimination shape;
  double squares_px2 = 0.0;
};

using RowMajor = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;

bool AddView(std::size_t v, bool by_place, CameraSolution& s, Sums& sums) {
  const int n = s.IntrinsicsCount(), w = s.WarpCount(), common = n + w, start = s.ViewStart(v);
  RowMajor J_lens(2, n), J_warp(2, kWarpSize), J_pose(2, kPoseSize), J_corner(2, kCornerSize),
      J(2, common + kPoseSize);
  double* jacobians[] = {J_lens.data(), J_warp.data(), J_pose.data(), J_corner.data()};
  const Eigen::VectorXd lens = IntrinsicsVector(s.camera);
  const Vector6d no_step = Vector6d::Zero();
  SolvedView& view = s.views[v];
  view.residual_px.assign(view.px.size(), Eigen::Vector2d::Zero());
  Eigen::MatrixXd JtJ = Eigen::MatrixXd::Zero(J.cols(), J.cols());
  for (std::size_t i = 0; i < view.px.size(); ++i) {
    const Eigen::Vector3d place = s.shape.Of(view.ids[i]);
    const double* at[] = {lens.data(), s.warp.bulge_m.data(), no_step.data(), place.data()};
    const auto error = MakeCornerError(s, view, i, by_place);
    if (!error->Evaluate(at, view.residual_px[i].data(), jacobians)) return false;
    if (!view.IsUsed(i)) continue;
    J << J_lens, J_warp.leftCols(w), J_pose;
    JtJ += J.transpose() * J;
    sums.squares_px2 += view.residual_px[i].squaredNorm();
    if (!by_place) continue;
    const int id = view.ids[i];
    sums.shape.Add(id, J_corner);
    sums.shape.Add(id, J_corner, J.leftCols(common), 0, s.Size());
    sums.shape.Add(id, J_corner, J_pose, start, s.Size());
  }
  s.normal_matrix.topLeftCorner(common, common) += JtJ.topLeftCorner(common, common);
  s.normal_matrix.block(0, start, common, kPoseSize) = JtJ.topRightCorner(common, kPoseSize);
  s.normal_matrix.block(start, 0, kPoseSize, common) = JtJ.bottomLeftCorner(kPoseSize, common);
  s.normal_matrix.block(start, start, kPoseSize, kPoseSize) =
      JtJ.bottomRightCorner(kPoseSize, kPoseSize);
  return true;
}

}  // namespace

bool EvaluateSolution(const BundleOptions& options, CameraSolution& s) {
  Sums sums;
  s.normal_matrix.setZero(s.Size(), s.Size());
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    if (!AddView(v, options.estimate_shape, s, sums)) return false;
  }
  double parameters = options.fix_intrinsics ? s.Size() - s.IntrinsicsCount() : s.Size();
  if (options.estimate_shape) {
    sums.shape.Eliminate(ShapeWeight(s.noise_px, s.shape), s.normal_matrix);
    parameters += sums.shape.Scatter(InverseOf(s.normal_matrix), s.noise_px, s.shape);
  }
  const double surplus = std::max(1.0, 2.0 * s.CornersUsed() - parameters);
  s.noise_px = std::sqrt(sums.squares_px2 / surplus);
  return std::isfinite(s.noise_px) && s.normal_matrix.allFinite();
}

}  // namespace flextip
