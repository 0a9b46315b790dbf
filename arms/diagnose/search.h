// Which effects an arm has: hypotheses weighed about the best place, likely ones fitted themselves,
// and the noise measured again from what the best one leaves, until nothing changes.
#pragma once

#include <map>
#include <vector>

#include "arms/diagnose/noise.h"
#include "arms/diagnose/problem.h"
#include "arms/replay/replay.h"
#include "diagnosis/evidence/evidence.h"

namespace flextip::arms {

struct SearchOptions {
  int parts = 20;             ///< of a recording, for bagging and held-out stretches
  double discrepancy = 0.02;  ///< what a right form may miss of what is to be explained, relative
  int most_effects = 6;       ///< together
  int beam = 8;               ///< hypotheses of each size that are extended
  double prior_none = 0.5, prior_single = 0.33, prior_pair = 0.08, prior_more = 0.25;
  double prior_unknown = 0.05;
};

struct Scored {
  diagnosis::WeighedHypothesis weighed;
  double log_posterior = 0.0;  ///< not normalised
  double correction = 0.0;     ///< of it: what its own fit says beyond the linear problem
};

struct Found {
  std::vector<Scored> scored;  ///< best first
  Problem problem;             ///< about the best place
  Eigen::VectorXd generic_sd;
  Noise noise;
  std::vector<Eigen::VectorXd> sizes;
  Eigen::VectorXd base_theta;        ///< of the base: nuisances alone
  std::map<int, double> importance;  ///< of each effect of the best: what its lack adds to the rest
  std::vector<int> not_claimed;      ///< likely by their evidence, but lost in what is left
  int fits = 0;
  bool converged = false;

  const Scored& BestKnown() const;
};

/// Leaves `replay` at the best place.
Found Search(Replay& replay, Layout& layout, const SearchOptions& options = {});

/// Fits nuisances alone, from where the replay is.
void FitNuisances(Replay& replay, const Noise& noise, int rounds = 4);

/// Returns the parameters with those that are each recording's own (a tracker's place) moved one
/// step to where they fit, about where the replay is.
Eigen::VectorXd FitOwn(const Replay& replay, const Noise& noise);

double LogPriorOf(const diagnosis::Hypothesis& hypothesis, int effects,
                  const SearchOptions& options);

}  // namespace flextip::arms
