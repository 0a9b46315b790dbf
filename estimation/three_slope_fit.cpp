#include "estimation/three_slope_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/levenberg_marquardt.h"

namespace flextip {
namespace {

// Parameters in units of the length: x = (F_p L^2 / EI, a / L).
struct SlopeModel {
  Eigen::Vector3d y;               // (3.2) at wrist, port, tip
  Eigen::Matrix<double, 3, 2> dy;  // by x
};

SlopeModel Evaluate(const Eigen::Vector2d& x) {
  const double F = x[0], a = x[1], b = 1.0 - a, ab = a * b, c = b - a;
  SlopeModel model;
  const Eigen::Vector3d per_F(-ab * (1.0 + b) / 6.0, -ab * c / 3.0, ab * (1.0 + a) / 6.0);
  model.y = F * per_F;
  model.dy.col(0) = per_F;
  model.dy.col(1) = F * Eigen::Vector3d(-(c * (1.0 + b) - ab) / 6.0, -(c * c - 2.0 * ab) / 3.0,
                                        (c * (1.0 + a) + ab) / 6.0);
  return model;
}

// Inverse of the slopes' covariance, see FitFromSlopes.
Eigen::Matrix3d Information(const Eigen::Vector3d& y, const SlopeNoise& noise) {
  const Eigen::Vector3d rate = Eigen::Vector3d::Ones() + y.cwiseAbs2();
  Eigen::Vector3d sd(noise.wrist_rad, noise.port_rad, noise.tip_rad);
  sd = sd.cwiseMax(std::max(1e-6 * sd.maxCoeff(), 1e-9));  // nothing is measured without noise
  Eigen::Matrix3d covariance = rate * rate.transpose() * noise.chord_rad * noise.chord_rad;
  covariance.diagonal() += rate.cwiseProduct(sd).cwiseAbs2();
  return covariance.inverse();
}

// Levenberg's method with an analytic Jacobian.
struct Solution {
  Eigen::Vector2d x = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double chi2 = 0.0;
  int iterations = 0;
  bool converged = false;
};
Solution Minimise(const Eigen::Vector3d& y, const Eigen::Matrix3d& W, Eigen::Vector2d x) {
  SlopeModel model = Evaluate(x), there;
  Eigen::Vector2d tried;
  const auto chi2 = [&](const SlopeModel& at) { return (y - at.y).dot(W * (y - at.y)); };
  const auto try_step = [&](double damping) -> TrialStep {
    Eigen::Matrix2d H = model.dy.transpose() * W * model.dy;
    const Eigen::Vector2d gradient = model.dy.transpose() * W * (y - model.y);
    H.diagonal() *= 1.0 + damping;
    const Eigen::Vector2d step = H.inverse() * gradient;
    tried = x + step;
    there = Evaluate(tried);
    return {chi2(there), step.cwiseAbs().maxCoeff() < 1e-12 * (1.0 + std::abs(x[0]))};
  };
  const auto accept = [&] {
    x = tried;
    model = there;
  };
  const DescentResult descent = Descend(
      chi2(model), std::ref(try_step), std::ref(accept),
      {.max_iterations = 100, .least_raised = 0.0, .most_damping = 1e12, .relative_gain = 0.0});
  return {.x = x,
          .covariance = (model.dy.transpose() * W * model.dy).inverse(),
          .chi2 = descent.cost,
          .iterations = descent.tried,
          .converged = descent.settled};
}

}  // namespace

ThreeSlopeFit FitFromThreeSlopes(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                                 const Eigen::Vector3d& t_wrist, const Eigen::Vector3d& t_port,
                                 const Eigen::Vector3d& t_tip, double length_m,
                                 const SlopeNoise& noise, double significance) noexcept {
  ThreeSlopeFit fit;
  const double L = length_m;
  // The closed form settles bad input and the unbent shaft, and gives the start.
  fit.beam = FitFromSlopes(p_RW, p_RE, t_wrist, t_tip, L, noise, significance);
  if (!std::isfinite(t_port.norm()) || !(t_port.norm() > 0) || !std::isfinite(noise.port_rad)) {
    fit.beam = BeamFit{};
    return fit;
  }
  const BeamSlopes slopes = MeasureSlopes(p_RW, p_RE, t_wrist, t_tip, noise, significance);
  if (slopes.status != BeamStatus::kOk || fit.beam.status == BeamStatus::kBadInput) return fit;
  const double along = t_port.dot(slopes.R_RM.col(0));
  fit.beam.status = BeamStatus::kNoPort;
  fit.beam.F_p_over_EI = fit.beam.a = 0.0;
  fit.beam.covariance.setZero();
  if (along <= 0) return fit;
  const Eigen::Vector3d y(slopes.wrist, t_port.dot(slopes.R_RM.col(1)) / along, slopes.tip);

  const double place = std::clamp((2.0 * y[2] + y[0]) / (y[2] - y[0]), 0.1, 0.9);
  const Eigen::Vector2d start(2.0 * (y[2] - y[0]) / (place * (1.0 - place)), place);
  const Solution solution = Minimise(y, Information(y, noise), start);
  fit.iterations = solution.iterations;
  fit.chi2 = solution.chi2;
  if (!solution.converged || !(solution.x[0] < 0) || !(solution.x[1] > kPortMargin) ||
      !(solution.x[1] < 1.0 - kPortMargin) || !solution.covariance.allFinite()) {
    return fit;
  }
  fit.beam.status = BeamStatus::kOk;
  fit.beam.F_p_over_EI = solution.x[0] / (L * L);
  fit.beam.a = solution.x[1] * L;
  const Eigen::Vector2d unit(1.0 / (L * L), L);
  fit.beam.covariance = unit.asDiagonal() * solution.covariance * unit.asDiagonal();
  fit.gamma_rad = std::atan(y[0]) - std::atan(Evaluate(solution.x).y[0]);  // (5.23)
  return fit;
}

}  // namespace flextip
