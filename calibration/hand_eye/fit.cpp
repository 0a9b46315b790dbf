#include "calibration/hand_eye/fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/levenberg_marquardt.h"
#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr int kMaxIterations = 100;
constexpr double kConverged = 1e-9;  // of the cost
// Where a motion leaves something open the steps along it never end; chi2 says when they mean
// nothing.
constexpr double kMeansNothing = 0.01;

struct Linearised {
  std::vector<ViewNormal> views;
  SharedMatrix U = SharedMatrix::Zero(kShared, kShared);
  double cost = 0.0;
};

std::optional<Linearised> Linearise(const HandEyeProblem& problem, const HandEyeState& state) {
  const CameraModel camera(state.camera);
  Linearised all;
  for (std::size_t i = 0; i < problem.views.size(); ++i) {
    auto view = NormalOf(problem, problem.views[i], camera, state, state.T_RW[i]);
    if (!view) return {};
    all.U += view->U;
    all.cost += view->Cost();
    all.views.push_back(*view);
  }
  return all;
}

struct Step {
  SharedVector shared = SharedVector::Zero(kShared);
  std::vector<Vector6d> wrists;
};

// Both blocks are damped by their diagonals.
Step Solve(const Linearised& at, const std::vector<int>& unknowns, double damping) {
  SharedMatrix H = at.U;
  H.diagonal() *= 1 + damping;
  SharedVector g = SharedVector::Zero(kShared);
  std::vector<Ldlt<6>> solvers;
  for (const ViewNormal& view : at.views) {
    Matrix6d V = view.V;
    V.diagonal() *= 1 + damping;
    const auto& solver = solvers.emplace_back(V);
    H.noalias() -= view.W * solver.Solve(view.W.transpose());
    g += view.g - view.W * solver.Solve(view.h);
  }
  Step step;
  const Eigen::MatrixXd H_unknown = H(unknowns, unknowns);
  const Eigen::VectorXd g_unknown = g(unknowns);
  const Eigen::VectorXd x = -Ldlt(H_unknown).Solve(g_unknown);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    step.shared[unknowns[static_cast<std::size_t>(i)]] = x[i];
  for (std::size_t i = 0; i < at.views.size(); ++i) {
    const ViewNormal& view = at.views[i];
    step.wrists.emplace_back(-solvers[i].Solve(view.h + view.W.transpose() * step.shared));
  }
  return step;
}

HandEyeState Moved(const HandEyeState& from, const Step& step) {
  HandEyeState to = from;
  to.T_FC = MovePose(from.T_FC, step.shared.head<6>());
  to.T_KB = MovePose(from.T_KB, step.shared.segment<6>(6));
  to.time_step_s += step.shared[kTimeColumn];
  to.camera.fu_px += step.shared[kIntrinsicsColumn];
  to.camera.fv_px += step.shared[kIntrinsicsColumn + 1];
  to.camera.cu_px += step.shared[kIntrinsicsColumn + 2];
  to.camera.cv_px += step.shared[kIntrinsicsColumn + 3];
  for (std::size_t i = 0; i < from.T_RW.size(); ++i) {
    to.T_RW[i] = MovePose(from.T_RW[i], step.wrists[i]);
  }
  return to;
}

Eigen::MatrixXd CovarianceOf(const Linearised& at, const std::vector<int>& unknowns) {
  SharedMatrix H = SharedMatrix::Zero(kShared, kShared);
  for (const ViewNormal& view : at.views) H += view.Reduced();
  const Eigen::MatrixXd information = H(unknowns, unknowns);
  // Scaled to a unit diagonal: metres, radians and pixels are in it.
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const SymmetricEigen eigen(scaled);
  const Eigen::VectorXd inverse = eigen.values.cwiseMax(1e-14).cwiseInverse();
  return scale.asDiagonal() * eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose() *
         scale.asDiagonal();
}

// Foerstner's variance components: each group's chi2 over its share of the redundancy.
HandEyeVariances VariancesOf(const HandEyeProblem& problem, const Linearised& at,
                             const std::vector<int>& unknowns, const Eigen::MatrixXd& covariance) {
  double chi2_w = 0, chi2_p = 0, redundancy_w = 0, redundancy_p = 0, chi2_c = 0, residuals = 0;
  for (std::size_t i = 0; i < at.views.size(); ++i) {
    const ViewNormal& view = at.views[i];
    const double share = problem.views[i].wrist.noise_share;
    const Matrix6d prior = Lu(problem.noise.WristCovariance(share)).Inverse();
    const Matrix6d inverse = Lu(view.V).Inverse();
    const Eigen::MatrixXd W = view.W(unknowns, Eigen::all);
    const Matrix6d posterior = inverse + inverse * (W.transpose() * covariance * W) * inverse;
    const Vector6d known = (prior * posterior).diagonal();
    const Vector6d chi2 = view.wrist_step.cwiseProduct(prior * view.wrist_step);
    chi2_w += chi2.head<3>().sum();
    chi2_p += chi2.tail<3>().sum();
    redundancy_w += 3 - known.head<3>().sum();
    redundancy_p += 3 - known.tail<3>().sum();
    chi2_c += view.corners_chi2;
    residuals += 2.0 * static_cast<double>(problem.views[i].points.size());
  }
  const double redundancy_c =
      residuals - static_cast<double>(unknowns.size()) - redundancy_w - redundancy_p;
  const auto over = [](double chi2, double r) { return r > 0.5 ? chi2 / r : 1.0; };
  return {over(chi2_c, redundancy_c), over(chi2_w, redundancy_w), over(chi2_p, redundancy_p)};
}

}  // namespace

Matrix6d HandEyeNoise::WristCovariance(double share) const {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(orientation_rad * orientation_rad),
      Eigen::Vector3d::Constant(position_m * position_m);
  return Matrix6d((share * variance).asDiagonal());
}

std::vector<int> HandEyeProblem::Unknowns() const {
  std::vector<int> unknowns(12);
  std::iota(unknowns.begin(), unknowns.end(), 0);
  if (time_offset) unknowns.push_back(kTimeColumn);
  for (int i = 0; intrinsics && i < 4; ++i) unknowns.push_back(kIntrinsicsColumn + i);
  return unknowns;
}

SharedMatrix ViewNormal::Reduced() const { return U - W * Ldlt(V).Solve(W.transpose()); }

std::optional<ViewNormal> NormalOf(const HandEyeProblem& problem, const FitView& view,
                                   const CameraModel& camera, const HandEyeState& state,
                                   const Pose& T_RW) {
  const auto corners =
      ResidualsOfChain(problem.mount, camera, view.points, state.T_FC, state.T_KB, T_RW);
  if (!corners) return {};
  const double weight = 1 / (problem.noise.corner_px * problem.noise.corner_px);
  ViewNormal n;
  n.U.noalias() = weight * corners->J.transpose() * corners->J;
  n.W.noalias() = weight * corners->J.transpose() * corners->J_wrist;
  n.V.noalias() = weight * corners->J_wrist.transpose() * corners->J_wrist;
  n.g.noalias() = weight * corners->J.transpose() * corners->r_px;
  n.h.noalias() = weight * corners->J_wrist.transpose() * corners->r_px;
  n.corners_chi2 = weight * corners->r_px.squaredNorm();

  const Vector6d velocity = view.wrist.velocity.value_or(Vector6d::Zero());
  const Pose measured = MovePose(view.wrist.T_RW, velocity * state.time_step_s);
  const Matrix6d prior = Lu(problem.noise.WristCovariance(view.wrist.noise_share)).Inverse();
  n.wrist_step = PoseDifference(measured, T_RW);
  const Vector6d pull = prior * n.wrist_step;
  n.V += prior;
  n.h += pull;
  n.wrist_chi2 = n.wrist_step.dot(pull);
  n.U(kTimeColumn, kTimeColumn) += velocity.dot(prior * velocity);
  n.W.row(kTimeColumn) -= velocity.transpose() * prior;
  n.g[kTimeColumn] -= velocity.dot(pull);
  return n;
}

std::optional<HandEyeFit> FitHandEye(const HandEyeProblem& problem, HandEyeState start) {
  const std::vector<int> unknowns = problem.Unknowns();
  start.T_RW.clear();
  for (const FitView& view : problem.views) start.T_RW.push_back(view.wrist.T_RW);
  HandEyeFit fit{std::move(start), {}, {}, {}, 0.0};
  auto at = Linearise(problem, fit.state);
  if (!at) return {};
  HandEyeState next;
  std::optional<Linearised> there;
  const auto try_step = [&](double damping) -> TrialStep {
    next = Moved(fit.state, Solve(*at, unknowns, damping));
    const bool valid = next.camera.fu_px > 0 && next.camera.fv_px > 0 && next.T_FC.p.allFinite();
    there = valid ? Linearise(problem, next) : std::nullopt;
    return {.cost = there ? there->cost : HUGE_VAL};
  };
  const auto accept = [&] {
    fit.state = std::move(next);
    at = std::move(there);
  };
  const DescentResult descent = Descend(
      at->cost, try_step, accept, {.max_iterations = kMaxIterations, .relative_gain = kConverged});
  // Exhausted: only rounding is left.
  if (!descent.settled && !descent.exhausted && descent.last_gain > kMeansNothing) return {};
  fit.cost = at->cost;
  fit.covariance = CovarianceOf(*at, unknowns);
  fit.variances = VariancesOf(problem, *at, unknowns, fit.covariance);
  for (const ViewNormal& view : at->views) fit.wrist_steps.push_back(view.wrist_step);
  return fit;
}

}  // namespace flextip
