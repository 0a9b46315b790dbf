#include "calibration/camera_bundle.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "calibration/lens_function.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr int kPose = 6, kWarp = 2;

// One corner. The pose is a step (dw, dp) from where the view's pose is now.
template <Distortion kModel, int kTerms>
struct CornerError {
  Eigen::Vector3d x_B;        // of the flat board
  Eigen::Vector2d shape, px;  // BoardWarp::Shape
  Eigen::Matrix3d R;          // where the pose step starts
  Eigen::Vector3d p;

  template <class T>
  bool operator()(const T* intrinsics, const T* warp, const T* step, T* error) const {
    const T z = x_B.z() + shape.x() * warp[0] + shape.y() * warp[1];
    const Eigen::Matrix<T, 3, 1> bent(T(x_B.x()), T(x_B.y()), z);
    const Eigen::Matrix<T, 3, 1> turned = R.cast<T>() * bent;
    Eigen::Matrix<T, 3, 1> x_C;
    ceres::AngleAxisRotatePoint(step, turned.data(), x_C.data());
    for (int i = 0; i < 3; ++i) x_C[i] += p[i] + step[3 + i];
    if (!(x_C.z() > T(0.0))) return false;
    const Eigen::Matrix<T, 2, 1> at = ProjectLens<kModel, kTerms>(intrinsics, x_C);
    error[0] = at.x() - px.x();
    error[1] = at.y() - px.y();
    return true;
  }
};

template <Distortion kModel, int kTerms>
ceres::CostFunction* MakeError(const SolvedView& view, std::size_t i, const BoardWarp& warp) {
  using Error = CornerError<kModel, kTerms>;
  return new ceres::AutoDiffCostFunction<Error, 2, 4 + kTerms, kWarp, kPose>(
      new Error{view.x_B[i], warp.Shape(view.x_B[i]), view.px[i], view.T_CB.R, view.T_CB.p});
}

ceres::CostFunction* MakeError(const CameraSolution& s, const SolvedView& view, std::size_t i) {
  switch (s.camera.distortion) {
    case Distortion::kEquidistant:
      return MakeError<Distortion::kEquidistant, 4>(view, i, s.warp);
    case Distortion::kRadialTangential:
      return MakeError<Distortion::kRadialTangential, 4>(view, i, s.warp);
    case Distortion::kOpenCv:
      break;
  }
  switch (s.camera.distortion_coefficients.size()) {
    case 5:
      return MakeError<Distortion::kOpenCv, 5>(view, i, s.warp);
    case 8:
      return MakeError<Distortion::kOpenCv, 8>(view, i, s.warp);
    default:
      return MakeError<Distortion::kOpenCv, 12>(view, i, s.warp);
  }
}

std::vector<double> IntrinsicsOf(const CameraCalibration& c) {
  std::vector<double> v = {c.fu_px, c.fv_px, c.cu_px, c.cv_px};
  v.insert(v.end(), c.distortion_coefficients.begin(), c.distortion_coefficients.end());
  return v;
}

void SetIntrinsics(const std::vector<double>& v, CameraCalibration& c) {
  c.fu_px = v[0];
  c.fv_px = v[1];
  c.cu_px = v[2];
  c.cv_px = v[3];
  c.distortion_coefficients.assign(v.begin() + 4, v.end());
}

using PoseStep = Eigen::Matrix<double, kPose, 1>;

// What Ceres moves.
struct Parameters {
  std::vector<double> intrinsics;
  Eigen::Vector2d warp_m;
  std::vector<PoseStep> steps;

  explicit Parameters(const CameraSolution& s)
      : intrinsics(IntrinsicsOf(s.camera)),
        warp_m(s.warp.bulge_m),
        steps(s.views.size(), PoseStep::Zero()) {}

  bool Finite() const {
    const auto finite = [](double v) { return std::isfinite(v); };
    return std::all_of(intrinsics.begin(), intrinsics.end(), finite) && intrinsics[0] > 0 &&
           intrinsics[1] > 0 && warp_m.allFinite() &&
           std::all_of(steps.begin(), steps.end(), [](const auto& p) { return p.allFinite(); });
  }

  void MoveInto(CameraSolution& s) const {
    SetIntrinsics(intrinsics, s.camera);
    s.warp.bulge_m = warp_m;
    for (std::size_t v = 0; v < s.views.size(); ++v) {
      Pose& T_CB = s.views[v].T_CB;
      T_CB.R = ExpRotation(steps[v].head<3>()) * T_CB.R;
      T_CB.R = Eigen::Quaterniond(T_CB.R).normalized().toRotationMatrix();
      T_CB.p += steps[v].tail<3>();
    }
  }
};

void AddCorners(const CameraSolution& s, double cauchy_px, Parameters& at,
                ceres::Problem& problem) {
  ceres::LossFunction* loss = cauchy_px > 0 ? new ceres::CauchyLoss(cauchy_px) : nullptr;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    for (std::size_t i = 0; i < s.views[v].px.size(); ++i) {
      if (!s.views[v].IsUsed(i)) continue;
      problem.AddResidualBlock(MakeError(s, s.views[v], i), loss, at.intrinsics.data(),
                               at.warp_m.data(), at.steps[v].data());
    }
  }
}

bool Minimise(const CameraSolution& s, const BundleOptions& options, Parameters& at) {
  ceres::Problem problem;
  AddCorners(s, options.cauchy_px, at, problem);
  if (problem.NumResidualBlocks() == 0) return false;
  if (options.fix_intrinsics) {
    problem.SetParameterBlockConstant(at.intrinsics.data());
  } else if (!options.fixed.empty()) {
    problem.SetManifold(
        at.intrinsics.data(),
        new ceres::SubsetManifold(static_cast<int>(at.intrinsics.size()), options.fixed));
  }
  if (!options.estimate_warp) problem.SetParameterBlockConstant(at.warp_m.data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  solver.linear_solver_ordering->AddElementToGroup(at.intrinsics.data(), 1);
  solver.linear_solver_ordering->AddElementToGroup(at.warp_m.data(), 1);
  for (PoseStep& step : at.steps) {
    if (problem.HasParameterBlock(step.data())) {
      solver.linear_solver_ordering->AddElementToGroup(step.data(), 0);
    }
  }
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-10;
  solver.parameter_tolerance = 1e-11;
  solver.gradient_tolerance = 1e-12;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return summary.IsSolutionUsable() && at.Finite();
}

// Residuals, normal matrix and noise where the solution is.
bool Evaluate(const BundleOptions& options, CameraSolution& s) {
  const Parameters at(s);
  const int n = s.IntrinsicsCount(), w = s.WarpCount();
  using Jacobian = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
  Jacobian J_lens(2, n), J_warp(2, kWarp), J_pose(2, kPose), J(2, n + w + kPose);
  double* jacobians[] = {J_lens.data(), J_warp.data(), J_pose.data()};
  s.normal_matrix.setZero(s.Size(), s.Size());
  double squares_px2 = 0.0;
  for (std::size_t v = 0; v < s.views.size(); ++v) {
    SolvedView& view = s.views[v];
    view.residual_px.assign(view.px.size(), Eigen::Vector2d::Zero());
    Eigen::MatrixXd JtJ = Eigen::MatrixXd::Zero(J.cols(), J.cols());
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      const std::unique_ptr<ceres::CostFunction> error(MakeError(s, view, i));
      const double* parameters[] = {at.intrinsics.data(), at.warp_m.data(), at.steps[v].data()};
      if (!error->Evaluate(parameters, view.residual_px[i].data(), jacobians)) return false;
      if (!view.IsUsed(i)) continue;
      J << J_lens, J_warp.leftCols(w), J_pose;
      JtJ += J.transpose() * J;
      squares_px2 += view.residual_px[i].squaredNorm();
    }
    const int common = n + w, start = s.ViewStart(v);
    s.normal_matrix.topLeftCorner(common, common) += JtJ.topLeftCorner(common, common);
    s.normal_matrix.block(0, start, common, kPose) = JtJ.topRightCorner(common, kPose);
    s.normal_matrix.block(start, 0, kPose, common) = JtJ.bottomLeftCorner(kPose, common);
    s.normal_matrix.block(start, start, kPose, kPose) = JtJ.bottomRightCorner(kPose, kPose);
  }
  const int free = options.fix_intrinsics ? s.Size() - n : s.Size();
  const int surplus = std::max(1, 2 * s.CornersUsed() - free);
  s.noise_px = std::sqrt(squares_px2 / surplus);
  return std::isfinite(s.noise_px) && s.normal_matrix.allFinite();
}

}  // namespace

bool AdjustBundle(CameraSolution& solution, const BundleOptions& options) {
  CameraSolution moved = solution;
  moved.warp_estimated = options.estimate_warp;
  Parameters at(moved);
  if (!Minimise(moved, options, at)) return false;
  at.MoveInto(moved);
  if (!Evaluate(options, moved)) return false;
  solution = std::move(moved);
  return true;
}

}  // namespace flextip
