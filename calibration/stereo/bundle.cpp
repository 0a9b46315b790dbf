#include "calibration/stereo/bundle.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "calibration/camera/projection_derivative.h"
#include "calibration/camera/shape_elimination.h"
#include "core/matrix_types.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr int kPose = 6, kWarp = 2, kPlace = 3;

Pose Moved(const Pose& T, const Vector6d& step) {
  return {ExpRotation(step.head<3>()) * T.R, T.p + step.tail<3>()};
}

// One corner in one eye. Parameters: the eye's intrinsics, the warp, the step of T_C0B, for eye 1
// the step of T_C0C1 and, with `by_place`, the corner's offset; without, it is the solution's.
class CornerError : public ceres::CostFunction {
 public:
  CornerError(const StereoSolution& s, const StereoView& view, int eye, std::size_t corner,
              bool by_place)
      : camera_(s.cameras[eye]),
        warp_(s.warp),
        T_C0B_(view.T_C0B),
        x_B_(view.eyes[eye].x_B[corner]),
        offset_B_(s.shape.Of(view.eyes[eye].ids[corner])),
        by_place_(by_place),
        px_(view.eyes[eye].px[corner]) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {s.IntrinsicsCount(eye), kWarp, kPose};
    if (eye == 1) {
      T_C0C1_ = s.T_C0C1;
      mutable_parameter_block_sizes()->push_back(kPose);
    }
    if (by_place) mutable_parameter_block_sizes()->push_back(kPlace);
  }

  bool Evaluate(double const* const* at, double* error, double** jacobians) const override {
    const CameraCalibration camera = WithIntrinsics(
        camera_, Eigen::Map<const Eigen::VectorXd>(at[0], parameter_block_sizes()[0]));
    BoardWarp warp = warp_;
    warp.bulge_m = Eigen::Map<const Eigen::Vector2d>(at[1]);
    const Vector6d view_step = Eigen::Map<const Vector6d>(at[2]);
    Vector6d pair_step = Vector6d::Zero();
    if (T_C0C1_) pair_step = Eigen::Map<const Vector6d>(at[3]);
    const Pose T_C0B = Moved(T_C0B_, view_step);
    const Pose T_CC0 = T_C0C1_ ? Moved(*T_C0C1_, pair_step).Inverse() : Pose();
    const int place = T_C0C1_ ? 4 : 3;
    const Eigen::Vector3d offset_B =
        by_place_ ? Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(at[place])) : offset_B_;
    const Eigen::Vector3d x_C0 = T_C0B * (warp.Bent(x_B_) + offset_B), x_C = T_CC0 * x_C0;
    if (!(x_C.z() > 0)) return false;
    const ProjectionDerivative d = DifferentiateProjection(camera, x_C);
    error[0] = d.px.x() - px_.x();
    error[1] = d.px.y() - px_.y();
    if (!jacobians) return true;

    const Eigen::Matrix<double, 2, 3> by_C0 = d.by_point * T_CC0.R;
    const auto put = [&](int block, const Eigen::MatrixXd& J) {
      if (!jacobians[block]) return;
      for (int row = 0; row < 2; ++row) {
        Eigen::Map<Eigen::RowVectorXd>(jacobians[block] + row * J.cols(), J.cols()) = J.row(row);
      }
    };
    put(0, d.by_intrinsics);
    put(1, by_C0 * T_C0B.R.col(2) * warp.Shape(x_B_).transpose());
    Eigen::Matrix<double, 2, kPose> J;
    J << -by_C0 * Skew(x_C0 - T_C0B.p) * LeftJacobian(view_step.head<3>()), by_C0;
    put(2, J);
    if (by_place_) put(place, by_C0 * T_C0B.R);
    if (!T_C0C1_) return true;
    const Eigen::Vector3d y = x_C0 - T_C0C1_->p - pair_step.tail<3>();
    J << by_C0 * Skew(y) * LeftJacobian(pair_step.head<3>()), -by_C0;
    put(3, J);
    return true;
  }

 private:
  CameraCalibration camera_;
  BoardWarp warp_;
  Pose T_C0B_;
  Eigen::Vector3d x_B_, offset_B_;
  bool by_place_;
  Eigen::Vector2d px_;
  std::optional<Pose> T_C0C1_;
};

// What Ceres moves.
struct Parameters {
  std::array<Eigen::VectorXd, 2> intrinsics;
  Eigen::Vector2d warp_m;
  Vector6d pair = Vector6d::Zero();
  std::vector<Vector6d> views;
  std::map<int, Eigen::Vector3d> places;  // of the corners used, where the shape is estimated

  explicit Parameters(const StereoSolution& s)
      : intrinsics{IntrinsicsVector(s.cameras[0]), IntrinsicsVector(s.cameras[1])},
        warp_m(s.warp.bulge_m),
        views(s.views.size(), Vector6d::Zero()) {}

  std::vector<double*> Blocks(std::size_t view, int eye) {
    std::vector<double*> blocks = {intrinsics[eye].data(), warp_m.data(), views[view].data()};
    if (eye == 1) blocks.push_back(pair.data());
    return blocks;
  }

  bool Sane() const {
    return intrinsics[0].allFinite() && intrinsics[1].allFinite() && warp_m.allFinite() &&
           pair.allFinite() &&
           std::min(intrinsics[0].head<2>().minCoeff(), intrinsics[1].head<2>().minCoeff()) > 0 &&
           std::all_of(views.begin(), views.end(), [](const auto& v) { return v.allFinite(); }) &&
           std::all_of(places.begin(), places.end(),
                       [](const auto& p) { return p.second.allFinite(); });
  }

  void MoveInto(StereoSolution& s) const {
    for (int eye = 0; eye < 2; ++eye) {
      s.cameras[eye] = WithIntrinsics(s.cameras[eye], intrinsics[eye]);
    }
    s.warp.bulge_m = warp_m;
    if (!places.empty()) s.shape.offset_B = places;
    const auto move = [](Pose& T, const Vector6d& step) {
      T = Moved(T, step);
      T.R = Eigen::Quaterniond(T.R).normalized().toRotationMatrix();
    };
    move(s.T_C0C1, pair);
    for (std::size_t v = 0; v < views.size(); ++v) {
      move(s.views[v].T_C0B, views[v]);
      for (int eye = 0; eye < 2; ++eye) s.views[v].eyes[eye].T_CB = s.T_CB(s.views[v], eye);
    }
  }
};

void AddCorners(const StereoSolution& s, const StereoBundleOptions& options, Parameters& at,
                ceres::Problem& problem) {
  const bool by_place = options.estimate_shape;
  ceres::LossFunction* loss =
      options.cauchy_px > 0 ? new ceres::CauchyLoss(options.cauchy_px) : nullptr;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    for (int eye = 0; eye < 2; ++eye) {
      const SolvedView& seen = s.views[v].eyes[eye];
      for (std::size_t i = 0; i < seen.px.size(); ++i) {
        if (!seen.IsUsed(i)) continue;
        std::vector<double*> blocks = at.Blocks(v, eye);
        if (by_place) {
          const int id = seen.ids[i];
          blocks.push_back(at.places.try_emplace(id, s.shape.Of(id)).first->second.data());
        }
        problem.AddResidualBlock(new CornerError(s, s.views[v], eye, i, by_place), loss, blocks);
      }
    }
  }
  const double weight = by_place ? ShapeWeight(s.noise_px, s.shape) : 0.0;
  for (auto& [id, place] : at.places) {
    problem.AddResidualBlock(
        new ceres::NormalPrior(weight * Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()),
        nullptr, place.data());
  }
}

bool Minimise(const StereoSolution& s, const StereoBundleOptions& options, Parameters& at) {
  ceres::Problem problem;
  AddCorners(s, options, at, problem);
  if (problem.NumResidualBlocks() == 0) return false;
  ceres::Solver::Options solver;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (double* common :
       {at.intrinsics[0].data(), at.intrinsics[1].data(), at.warp_m.data(), at.pair.data()}) {
    if (!problem.HasParameterBlock(common)) continue;
    solver.linear_solver_ordering->AddElementToGroup(common, 1);
    if (options.fix_cameras || (common == at.warp_m.data() && !options.estimate_warp)) {
      problem.SetParameterBlockConstant(common);
    }
  }
  // Eliminated first: the many small blocks that do not touch each other.
  for (auto& [id, place] : at.places) {
    solver.linear_solver_ordering->AddElementToGroup(place.data(), 0);
  }
  for (Vector6d& view : at.views) {
    if (!problem.HasParameterBlock(view.data())) continue;
    solver.linear_solver_ordering->AddElementToGroup(view.data(), at.places.empty() ? 0 : 1);
  }
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-10;
  solver.parameter_tolerance = 1e-11;
  solver.gradient_tolerance = 1e-12;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return summary.IsSolutionUsable() && at.Sane();
}

// Adds J^T J of a corner, whose blocks begin at `starts`.
void AddNormal(const std::vector<Eigen::MatrixXd>& J, const std::vector<int>& starts,
               Eigen::MatrixXd& normal) {
  for (std::size_t a = 0; a < J.size(); ++a) {
    for (std::size_t b = 0; b < J.size(); ++b) {
      if (J[a].cols() == 0 || J[b].cols() == 0) continue;
      normal.block(starts[a], starts[b], J[a].cols(), J[b].cols()) += J[a].transpose() * J[b];
    }
  }
}

struct Sums {
  ShapeElimination shape;
  double squares_px2 = 0.0;
};

bool AddEye(std::size_t v, int eye, bool by_place, StereoSolution& s, Sums& sums) {
  using Rows = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
  Parameters at(s);
  SolvedView& seen = s.views[v].eyes[eye];
  seen.residual_px.assign(seen.px.size(), Eigen::Vector2d::Zero());
  std::vector<Rows> J = {Rows(2, s.IntrinsicsCount(eye)), Rows(2, kWarp), Rows(2, kPose)};
  std::vector<int> starts = {eye == 0 ? 0 : s.IntrinsicsCount(0), s.PairStart() + 6,
                             s.ViewStart(v)};
  if (eye == 1) {
    J.emplace_back(2, kPose);
    starts.push_back(s.PairStart());
  }
  Eigen::Matrix<double, 2, kPlace, Eigen::RowMajor> J_place;
  std::vector<double*> jacobians;
  jacobians.reserve(J.size() + 1);
  for (Rows& block : J) jacobians.push_back(block.data());
  jacobians.push_back(J_place.data());
  for (std::size_t i = 0; i < seen.px.size(); ++i) {
    Eigen::Vector3d place = s.shape.Of(seen.ids[i]);
    std::vector<double*> blocks = at.Blocks(v, eye);
    blocks.push_back(place.data());
    const CornerError error(s, s.views[v], eye, i, by_place);
    if (!error.Evaluate(blocks.data(), seen.residual_px[i].data(), jacobians.data())) return false;
    if (!seen.IsUsed(i)) continue;
    sums.squares_px2 += seen.residual_px[i].squaredNorm();
    std::vector<Eigen::MatrixXd> used(J.begin(), J.end());
    used[1] = J[1].leftCols(s.WarpCount());
    AddNormal(used, starts, s.normal_matrix);
    if (!by_place) continue;
    sums.shape.Add(seen.ids[i], J_place);
    for (std::size_t k = 0; k < used.size(); ++k) {
      sums.shape.Add(seen.ids[i], J_place, used[k], starts[k], s.Size());
    }
  }
  return true;
}

// Residuals, normal matrix and noise where the solution is.
bool Evaluate(const StereoBundleOptions& options, StereoSolution& s) {
  Sums sums;
  s.normal_matrix.setZero(s.Size(), s.Size());
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    for (int eye = 0; eye < 2; ++eye) {
      if (!AddEye(v, eye, options.estimate_shape, s, sums)) return false;
    }
  }
  double parameters = s.Size() - (options.fix_cameras ? s.ViewStart(0) : 0);
  if (options.estimate_shape) {
    sums.shape.Eliminate(ShapeWeight(s.noise_px, s.shape), s.normal_matrix);
    parameters += sums.shape.Scatter(InverseOf(s.normal_matrix), s.noise_px, s.shape);
  }
  s.noise_px = std::sqrt(sums.squares_px2 / std::max(1.0, 2.0 * s.CornersUsed() - parameters));
  return std::isfinite(s.noise_px) && s.normal_matrix.allFinite();
}

}  // namespace

bool AdjustStereo(StereoSolution& solution, const StereoBundleOptions& options) {
  StereoSolution moved = solution;
  moved.warp_estimated = options.estimate_warp;
  Parameters at(moved);
  if (!Minimise(moved, options, at)) return false;
  at.MoveInto(moved);
  if (!Evaluate(options, moved)) return false;
  solution = std::move(moved);
  return true;
}

}  // namespace flextip
