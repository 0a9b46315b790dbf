// The full fit of one hypothesis: a replay moved, round by round, to where the hypothesis explains
// the recording best.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "diagnosis/search/hypotheses.h"

namespace flextip::diagnosis {

/// Hypotheses weighed on the problem about the point where a replay stands.
struct Weighing {
  LinearProblem problem;
  Eigen::VectorXd generic_sd;
  std::vector<ScoredHypothesis> scored;  ///< best first
  double log_none = 0.0;                 ///< log evidence of none, comparable between points
  Eigen::VectorXd target;                ///< where the best hypothesis has the parameters
  Eigen::VectorXd prior_sd;              ///< of the parameters under the best hypothesis
  double distance = 0.0;                 ///< from here to the target, in standard deviations
  /// What the linear problem promises between here and its target, in log odds: not had yet.
  double promised = 0.0;

  const Hypothesis& Best() const { return scored.front().weighed.hypothesis; }
  double LogPosterior() const { return scored.front().log_posterior + log_none; }
};

/// The linear problem about the point where `replay` stands, unknown forces' volume included.
/// Problems are comparable where their generic basis is the same.
LinearProblem ProblemHere(const Replay& replay, const Eigen::MatrixXd& basis,
                          const SelectionOptions& options);

/// What the right form of an effect may miss of each row, in standard deviations: `part` of what
/// there is to explain (LinearProblem::residual_size).
Rows MayMiss(const Rows& residual_size, double part, const SelectionOptions& options);

/// Standard deviations of the generic coefficients; those of a row share what the row may miss.
Eigen::VectorXd GenericSd(const LinearProblem& problem, const Rows& may_miss);

/// `grow`: and the leaders of them with more effects (Grown).
Weighing Weigh(const Replay& replay, LinearProblem here, const std::vector<Hypothesis>& hypotheses,
               const SelectionOptions& options, const Rows& may_miss, bool grow = false);

/// Towards the weighing's target as far as that explains more than standing still: the problem
/// there. Empty: nowhere, and the replay is where it was.
std::optional<LinearProblem> MoveToTarget(Replay& replay, const Weighing& weighing,
                                          const Eigen::MatrixXd& basis,
                                          const SelectionOptions& options);

/// Where a replay stands, to come back to.
struct Place {
  Eigen::VectorXd theta;
  std::vector<Eigen::Vector3d> forces_N;
  std::vector<double> scan_centres;  ///< of the layout's scanned parameters
};
Place PlaceOf(const Replay& replay);
void GoTo(Replay& replay, ParameterLayout& layout, const Place& place);

/// A hypothesis fitted by itself: its log posterior as far as the fit got.
struct HypothesisFit {
  Hypothesis hypothesis;
  double log_posterior = -1e300;
  double distance = 0.0;  ///< left, in standard deviations
  Place place;
};

struct FitOptions {
  const Eigen::MatrixXd& basis;  ///< of the generic terms
  Rows may_miss = Rows::Zero();
  int rounds = 4;
  int scans = 0;          ///< rounds, from the second on, that scan parameters such as a frequency
  bool scan_own = false;  ///< and those of the hypothesis' own effects
  double worth = -1e300;  ///< log posterior below which, clearly, the fit is given up
};

/// From where the replay stands.
HypothesisFit FitHypothesis(Replay& replay, ParameterLayout& layout, const Hypothesis& hypothesis,
                            const SelectionOptions& options, const FitOptions& fit_options);

}  // namespace flextip::diagnosis
