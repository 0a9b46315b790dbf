// Which effects an arm has: hypotheses weighed about the best place, likely ones fitted themselves,
// and the noise measured again from what the best one leaves, until nothing changes.
#pragma once

#include <map>
#include <vector>

#include "arms/replay/replay.h"
#include "arms/search/noise.h"
#include "arms/search/problem.h"
#include "arms/search/score.h"

namespace flextip::arms {

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

}  // namespace flextip::arms
