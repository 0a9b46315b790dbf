#include "core/levenberg_marquardt.h"

#include <algorithm>
#include <utility>

#include "core/linear_algebra.h"

namespace flextip {

DescentResult Descend(double cost, const std::function<TrialStep(double damping)>& try_step,
                      const std::function<void()>& accept, const DescentOptions& options) {
  DescentResult result{.cost = cost};
  double damping = options.start_damping;
  while (result.tried < options.max_iterations && !result.settled && !result.exhausted) {
    const TrialStep trial = try_step(damping);
    ++result.tried;
    const double most = result.cost + options.allowed_rise * std::abs(result.cost);
    if (trial.settled || trial.cost <= most) {
      accept();
      result.last_gain = result.cost - trial.cost;
      result.settled = trial.settled ||
                       (options.relative_gain > 0 &&
                        result.last_gain < options.relative_gain * (1.0 + std::abs(result.cost)));
      result.cost = trial.cost;
      damping *= options.shrink;
      if (damping < options.least_damping) damping = options.floor;
    } else {
      damping = std::max(options.least_raised, options.grow * damping);
      result.exhausted = damping > options.most_damping;
    }
  }
  return result;
}

Eigen::VectorXd DampedStep(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, double damping) {
  const Eigen::VectorXd unit = H.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = unit.asDiagonal() * H * unit.asDiagonal();
  scaled.diagonal() *= 1.0 + damping;
  return -unit.cwiseProduct(Ldlt(scaled).Solve(unit.cwiseProduct(g)));
}

DescentResult MinimiseSquares(
    const std::function<bool(const Eigen::VectorXd& x, Residuals& at)>& evaluate,
    Eigen::VectorXd& x, const DescentOptions& options) {
  Residuals at, there;
  if (!evaluate(x, at)) return {.cost = HUGE_VAL};
  Eigen::VectorXd moved;
  const auto try_step = [&](double damping) -> TrialStep {
    moved = x + DampedStep(at.J.transpose() * at.J, at.J.transpose() * at.r, damping);
    if (!moved.allFinite() || !evaluate(moved, there)) return {};
    return {.cost = there.r.squaredNorm()};
  };
  const auto accept = [&] {
    x = moved;
    std::swap(at, there);
  };
  return Descend(at.r.squaredNorm(), try_step, accept, options);
}

}  // namespace flextip
