// Tissue that drags on the shaft beyond the port: Maxwell elements between places of the shaft and
// the ground, each a spring in series with a dashpot.
#pragma once

#include "simulation/plant/chain_problem.h"
#include "simulation/plant/effects.h"
#include "simulation/plant/friction.h"
#include "simulation/plant/memory.h"
#include "simulation/plant/setup.h"

namespace flextip::simulation {

/// The tissue during one step of time.
class PlantTissue {
 public:
  /// `before`: the elements at the last equilibrium, `dt_s` ago (not positive: no relaxation);
  /// empty: at rest now. `p_RW`: the chain's origin in R.
  PlantTissue(const ShaftTissue& tissue, const PlantUnits& units, const Eigen::Vector3d& p_RW,
              double dt_s, const std::vector<TissueElement>& before);

  /// Improves `state` to the equilibrium of `problem` with the tissue's forces, by `solve`.
  bool Solve(ChainProblem& problem, ChainState& state, const ChainSolve& solve) const;

  /// The elements with the chain in `state`.
  std::vector<TissueElement> At(const ChainProblem& problem, const ChainState& state) const;

  /// Puts the forces of `elements` on the chain.
  void Apply(const std::vector<TissueElement>& elements, const ChainState& state,
             ChainProblem& problem) const;

 private:
  PlantUnits units_;
  Eigen::Vector3d p_RW_;
  const std::vector<TissueElement>& before_;
  double keep_, spring_;
};

}  // namespace flextip::simulation
