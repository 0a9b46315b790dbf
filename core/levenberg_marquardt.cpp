#include "core/levenberg_marquardt.h"

#include <algorithm>

#include "core/linear_algebra.h"

namespace flextip {

DescentResult Descend(double cost, const std::function<TrialStep(double damping)>& try_step,
                      const std::function<void()>& accept, const DescentOptions& options) {
  DescentResult result{.cost = cost, .damping = options.start_damping};
  double& damping = result.damping;
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

}  // namespace flextip
