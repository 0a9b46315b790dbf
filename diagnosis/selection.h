// Which effects are there: hypotheses weighed from the point where the best one fits, again and
// again until nothing changes.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/evidence.h"

namespace flextip {

struct SelectionOptions {
  int max_rounds = 8;
  int blocks = 20;                  ///< of time, for bagging and held-out parts
  double discrepancy = 0.04;        ///< what a right form may miss of its effect's signal, relative
  double first_discrepancy = 0.15;  ///< while linearised far from the answer
  double least_discrepancy = 0.1;   ///< of the noise
  double prior_none = 0.5, prior_singles = 0.33, prior_pairs = 0.08, prior_unknown = 0.05;
};

struct ScoredHypothesis {
  WeighedHypothesis weighed;
  double log_posterior = 0.0;  ///< evidence and prior odds, not normalised
};

struct Selection {
  bool converged = false;
  int rounds = 0;
  std::vector<ScoredHypothesis> scored;  ///< best first
  Hypothesis leader;                     ///< fitted by itself, where the rounds did not rest
  LinearProblem problem;                 ///< about the best point
  Eigen::VectorXd generic_sd;

  const ScoredHypothesis& Best() const { return scored.front(); }
  /// The best that names only what the catalogue holds.
  const WeighedHypothesis& BestKnown() const;
};

/// Moves `replay` to the best point and leaves it there.
Selection Select(Replay& replay, ParameterLayout& layout, const SelectionOptions& options = {});

/// All hypotheses weighed on `sums`.
std::vector<ScoredHypothesis> ScoreAll(const NormalSums& sums, const ParameterLayout& layout,
                                       const Eigen::VectorXd& generic_sd,
                                       const SelectionOptions& options);

std::vector<ScoredHypothesis> ScoreSome(const NormalSums& sums, const ParameterLayout& layout,
                                        const Eigen::VectorXd& generic_sd,
                                        const std::vector<Hypothesis>& hypotheses,
                                        const SelectionOptions& options,
                                        const EvidenceOptions& evidence = {});

}  // namespace flextip
