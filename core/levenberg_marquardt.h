// Levenberg and Marquardt's descent for small least-squares problems (Marquardt 1963; More 1978):
// a Gauss-Newton step whose normal matrix has its diagonal enlarged until the cost falls.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>

namespace flextip {

struct DescentOptions {
  int max_iterations = 100;  ///< steps tried, accepted or not
  double start_damping = 1e-6;
  double shrink = 0.1,
         grow = 10.0;            ///< of the damping, after a step that helped and one that did not
  double least_damping = 1e-12;  ///< after a step that helped; smaller ones become `floor`
  double floor = 1e-12;
  double least_raised = 1e-9;  ///< after a step that did not help
  double most_damping = 1e8;   ///< ends above this
  /// Settled where a step lowers the cost by less than this part of 1 + cost; 0: the trial says so.
  double relative_gain = 1e-9;
  double allowed_rise = 0.0;  ///< a step may raise the cost by this part of it, for rounding
};

struct DescentResult {
  bool settled = false;    ///< by the gain or by the trial's own word
  bool exhausted = false;  ///< the damping rose above the most: no step helps
  int tried = 0;
  double cost = 0.0;            ///< of the last state accepted
  double last_gain = HUGE_VAL;  ///< by which the last accepted step lowered the cost
  double damping = 0.0;         ///< for a next step
};

/// A step that was tried.
struct TrialStep {
  double cost = HUGE_VAL;  ///< after the step; HUGE_VAL where the step leads nowhere
  bool settled = false;    ///< the step is small enough to be the last; it is then accepted
};

/// Descends from a state with `cost`. `try_step` makes the damped step from the present state and
/// returns the cost after it; `accept` makes the state that was tried last the present one. Given
/// as std::ref of their callables, allocates nothing.
DescentResult Descend(double cost, const std::function<TrialStep(double damping)>& try_step,
                      const std::function<void()>& accept, const DescentOptions& options = {});

/// Returns the step -(H + damping diag(H))^-1 g. `H` is n x n, symmetric, of any scale a row; `g`
/// is the gradient, n.
Eigen::VectorXd DampedStep(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, double damping);

}  // namespace flextip
