#include "calibration/camera/camera_normal.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "calibration/camera/camera_corner_error.h"

namespace flextip {
namespace {

// J^T J of all parameters with the shape's, apart.
struct Normals {
  Eigen::MatrixXd A;  // of lens, warp and poses
  struct Corner {
    Eigen::MatrixXd with_A;  // 3 x A's size
    Eigen::Matrix3d own;
  };
  std::map<int, Corner> corners;
  double squares_px2 = 0.0;
};

using RowMajor = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;

bool AddView(std::size_t v, bool by_place, CameraSolution& s, Normals& normals) {
  const int n = s.IntrinsicsCount(), w = s.WarpCount(), common = n + w, start = s.ViewStart(v);
  RowMajor J_lens(2, n), J_warp(2, kWarpSize), J_pose(2, kPoseSize), J_corner(2, kCornerSize),
      J(2, common + kPoseSize);
  double* jacobians[] = {J_lens.data(), J_warp.data(), J_pose.data(), J_corner.data()};
  std::vector<double> lens = {s.camera.fu_px, s.camera.fv_px, s.camera.cu_px, s.camera.cv_px};
  const auto& terms = s.camera.distortion_coefficients;
  lens.insert(lens.end(), terms.begin(), terms.end());
  const Eigen::Matrix<double, kPoseSize, 1> no_step = Eigen::Matrix<double, kPoseSize, 1>::Zero();
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
    normals.squares_px2 += view.residual_px[i].squaredNorm();
    if (!by_place) continue;
    Normals::Corner& corner = normals.corners[view.ids[i]];
    if (corner.with_A.size() == 0) {
      corner = {Eigen::MatrixXd::Zero(kCornerSize, s.Size()), Eigen::Matrix3d::Zero()};
    }
    corner.own += J_corner.transpose() * J_corner;
    const Eigen::MatrixXd across = J_corner.transpose() * J;
    corner.with_A.leftCols(common) += across.leftCols(common);
    corner.with_A.middleCols<kPoseSize>(start) += across.rightCols<kPoseSize>();
  }
  normals.A.topLeftCorner(common, common) += JtJ.topLeftCorner(common, common);
  normals.A.block(0, start, common, kPoseSize) = JtJ.topRightCorner(common, kPoseSize);
  normals.A.block(start, 0, kPoseSize, common) = JtJ.bottomLeftCorner(kPoseSize, common);
  normals.A.block(start, start, kPoseSize, kPoseSize) = JtJ.bottomRightCorner(kPoseSize, kPoseSize);
  return true;
}

// The trace of the shape's covariance for a noise of 1 px, by the blocks' inverse:
// C^-1 + C^-1 B^T S^-1 B C^-1. `s.normal_matrix` is S already.
double ShapeTrace(const Normals& normals, const CameraSolution& s) {
  CameraSolution unit = s;
  unit.noise_px = 1.0;
  const Eigen::MatrixXd inverse = unit.Covariance();
  double trace = 0.0;
  for (const auto& [id, corner] : normals.corners) {
    const Eigen::Matrix3d own = corner.own.inverse();
    trace += own.trace();
    if (inverse.size() == 0) continue;
    const Eigen::MatrixXd back = own * corner.with_A;
    trace += (back * inverse * back.transpose()).trace();
  }
  return trace;
}

}  // namespace

double ShapeWeight(const CameraSolution& s) { return s.noise_px / s.shape.sd_m; }

bool EvaluateSolution(const BundleOptions& options, CameraSolution& s) {
  Normals normals;
  normals.A.setZero(s.Size(), s.Size());
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    if (!AddView(v, options.estimate_shape, s, normals)) return false;
  }
  const int n = s.IntrinsicsCount();
  double parameters = options.fix_intrinsics ? s.Size() - n : s.Size();
  s.normal_matrix = normals.A;
  if (options.estimate_shape) {
    const double prior = std::pow(ShapeWeight(s), 2);
    for (auto& [id, corner] : normals.corners) {
      corner.own.diagonal().array() += prior;
      s.normal_matrix -= corner.with_A.transpose() * corner.own.inverse() * corner.with_A;
    }
    const double trace = ShapeTrace(normals, s),
                 count = 3.0 * static_cast<double>(normals.corners.size());
    double squares = 0.0;
    for (const auto& [id, corner] : normals.corners) squares += s.shape.Of(id).squaredNorm();
    s.shape.scatter_m = std::sqrt((squares + s.noise_px * s.noise_px * trace) / count);
    parameters += std::max(0.0, count - prior * trace);
  }
  const double surplus = std::max(1.0, 2.0 * s.CornersUsed() - parameters);
  s.noise_px = std::sqrt(normals.squares_px2 / surplus);
  return std::isfinite(s.noise_px) && s.normal_matrix.allFinite();
}

}  // namespace flextip
