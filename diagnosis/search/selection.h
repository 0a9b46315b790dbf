// Which effects are there: hypotheses weighed from the point where the best one fits, and every one
// that looks better from there fitted itself, until none does.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/evidence/residual_memory.h"
#include "diagnosis/search/hypotheses.h"

namespace flextip::diagnosis {

struct Selection {
  bool converged = false;
  int fits = 0;
  int far_samples = 0;                   ///< left out (FarSamples)
  double chi2_per_dof = 0.0;             ///< of the best that the catalogue has
  std::vector<ScoredHypothesis> scored;  ///< best first
  LinearProblem problem;  ///< about the best point, with samples that remember counted as fewer
  ResidualMemory memory;  ///< of what the best answer leaves
  Eigen::VectorXd generic_sd;
  std::vector<Correction> corrections;  ///< of those that were fitted

  const ScoredHypothesis& Best() const { return scored.front(); }
  /// The best that names only what the catalogue holds.
  const WeighedHypothesis& BestKnown() const;
};

/// Moves `replay` to the best point and leaves it there.
Selection Select(Replay& replay, ParameterLayout& layout, const SelectionOptions& options = {});

}  // namespace flextip::diagnosis
