#include "calibration/camera/camera_bundle.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "calibration/camera/lens_function.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr int kPose = 6, kWarp = 2;
// Where a corner lands farther off the lens function has run away.
constexpr double kFarthest_px = 1e6;

// One corner. The pose is a step (dw, dp) from where the view's pose is now. Ceres's numbers
// differentiate the lens alone: they would be most of the time.
template <Distortion kModel, int kTerms>
class CornerError : public ceres::SizedCostFunction<2, 4 + kTerms, kWarp, kPose> {
 public:
  CornerError(const SolvedView& view, std::size_t i, const BoardWarp& warp)
      : x_B_(view.x_B[i]),
        shape_(warp.Shape(x_B_)),
        px_(view.px[i]),
        R_(view.T_CB.R),
        p_(view.T_CB.p) {}

  bool Evaluate(double const* const* at, double* error, double** jacobians) const override {
    const double *c = at[0], *step = at[2];
    const double z = x_B_.z() + shape_.x() * at[1][0] + shape_.y() * at[1][1];
    const Eigen::Vector3d turned = R_ * Eigen::Vector3d(x_B_.x(), x_B_.y(), z);
    Eigen::Matrix3d dx_dw;
    const Eigen::Vector3d x_C =
        Turn(step, turned, dx_dw) + p_ + Eigen::Map<const Eigen::Vector3d>(step + 3);
    if (!(x_C.z() > 0.0)) return false;
    Eigen::Matrix2d dd_dm;
    Eigen::Matrix<double, 2, kTerms> dd_dk;
    const Eigen::Vector2d m = x_C.head<2>() / x_C.z(), d = Lens(c + 4, m, dd_dm, dd_dk);
    error[0] = c[0] * d.x() + c[2] - px_.x();
    error[1] = c[1] * d.y() + c[3] - px_.y();
    if (!(std::abs(error[0]) + std::abs(error[1]) < kFarthest_px)) return false;
    if (!jacobians) return true;

    const Eigen::DiagonalMatrix<double, 2> focal(c[0], c[1]);
    if (jacobians[0]) {
      Eigen::Map<RowMajor<4 + kTerms>> J(jacobians[0]);
      J << d.x(), 0, 1, 0, focal.diagonal().x() * dd_dk.row(0), 0, d.y(), 0, 1,
          focal.diagonal().y() * dd_dk.row(1);
    }
    Eigen::Matrix<double, 2, 3> dm_dx;
    dm_dx << 1, 0, -m.x(), 0, 1, -m.y();
    const Eigen::Matrix<double, 2, 3> J_x = focal * dd_dm * dm_dx / x_C.z();
    if (jacobians[1]) {
      Eigen::Vector3d normal;
      const Eigen::Vector3d out = R_.col(2);
      ceres::AngleAxisRotatePoint(step, out.data(), normal.data());
      Eigen::Map<RowMajor<kWarp>> J(jacobians[1]);
      J = (J_x * normal) * shape_.transpose();
    }
    if (jacobians[2]) {
      Eigen::Map<RowMajor<kPose>> J(jacobians[2]);
      J << J_x * dx_dw, J_x;
    }
    return true;
  }

 private:
  template <int kColumns>
  using RowMajor = Eigen::Matrix<double, 2, kColumns, Eigen::RowMajor>;

  // exp([w]x) x with its derivative, -[exp([w]x) x]x times SO(3)'s left Jacobian.
  static Eigen::Vector3d Turn(const double* step, const Eigen::Vector3d& x, Eigen::Matrix3d& by_w) {
    const Eigen::Vector3d w(step[0], step[1], step[2]);
    Eigen::Vector3d turned;
    ceres::AngleAxisRotatePoint(step, x.data(), turned.data());
    const double angle2 = w.squaredNorm(), angle = std::sqrt(angle2);
    const bool small = angle < 1e-4;
    const double a = small ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
    const double b = small ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle * angle2);
    const Eigen::Matrix3d W = Skew(w);
    by_w = -Skew(turned) * (Eigen::Matrix3d::Identity() + a * W + b * W * W);
    return turned;
  }

  static Eigen::Vector2d Lens(const double* k, const Eigen::Vector2d& m, Eigen::Matrix2d& by_m,
                              Eigen::Matrix<double, 2, kTerms>& by_k) {
    using Jet = ceres::Jet<double, 2 + kTerms>;
    Jet coefficients[kTerms];
    for (int i = 0; i < kTerms; ++i) coefficients[i] = Jet(k[i], 2 + i);
    const Eigen::Matrix<Jet, 2, 1> d = DistortLens<kModel, kTerms>(
        coefficients, Eigen::Matrix<Jet, 2, 1>(Jet(m.x(), 0), Jet(m.y(), 1)));
    for (int i = 0; i < 2; ++i) {
      by_m.row(i) = d[i].v.template head<2>().transpose();
      by_k.row(i) = d[i].v.template tail<kTerms>().transpose();
    }
    return {d[0].a, d[1].a};
  }

  Eigen::Vector3d x_B_;         // of the flat board
  Eigen::Vector2d shape_, px_;  // BoardWarp::Shape
  Eigen::Matrix3d R_;           // where the pose step starts
  Eigen::Vector3d p_;
};

ceres::CostFunction* MakeError(const CameraSolution& s, const SolvedView& view, std::size_t i) {
  switch (s.camera.distortion) {
    case Distortion::kEquidistant:
      return new CornerError<Distortion::kEquidistant, 4>(view, i, s.warp);
    case Distortion::kRadialTangential:
      return new CornerError<Distortion::kRadialTangential, 4>(view, i, s.warp);
    case Distortion::kOpenCv:
      break;
  }
  switch (s.camera.distortion_coefficients.size()) {
    case 5:
      return new CornerError<Distortion::kOpenCv, 5>(view, i, s.warp);
    case 8:
      return new CornerError<Distortion::kOpenCv, 8>(view, i, s.warp);
    default:
      return new CornerError<Distortion::kOpenCv, 12>(view, i, s.warp);
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

// A step that cannot be solved for is taken again with more damping; Ceres writes it to stderr.
class QuietLog {
 public:
  QuietLog() : level_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~QuietLog() { FLAGS_minloglevel = level_; }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  int level_;
};

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
  // Always some damping: parameters that the views do not tell would make the matrix singular.
  solver.max_trust_region_radius = 1e7;
  solver.function_tolerance = options.tolerance;
  solver.parameter_tolerance = 1e-11;
  solver.gradient_tolerance = 1e-12;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  const QuietLog quiet;
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
