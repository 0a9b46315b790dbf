// The simulated instrument: a shaft pinned at the wrist, sliding through a port and loaded at the
// tip and by its weight, with whatever PlantEffects adds. Its equilibrium is that of a discrete
// elastic chain (chain.h), a method of its own: nothing here is shared with the models in
// kinematics/.
#pragma once

#include <Eigen/Dense>

#include "simulation/plant/chain_curvature.h"
#include "simulation/plant/chain_problem.h"
#include "simulation/plant/memory.h"
#include "simulation/plant/setup.h"
#include "simulation/plant/shape.h"

namespace flextip::simulation {

/// Finds one equilibrium after the other and starts each from the last.
class Plant {
 public:
  explicit Plant(const PlantSetup& setup, const PlantOptions& options = {});

  /// Returns the equilibrium with the wrist measured at `p_RW` (m, in R), at the time `t_s`: from
  /// the last equilibrium where there is one, otherwise from the straight shaft with the load
  /// applied in steps. Effects with a memory (backlash, friction, tissue on the shaft) go on from
  /// the last equilibrium found; a time before the last call's counts as no time passed.
  PlantShape Solve(const Eigen::Vector3d& p_RW, double t_s = 0.0);

  const PlantSetup& Setup() const { return setup_; }
  /// Changes the load; the next solve starts from the shape under the old one.
  void SetLoad(const TipLoad& load) { setup_.load = load; }
  /// Changes the effects; what has a memory keeps it, in units of the shaft's length, so that a
  /// shaft with friction must keep its length.
  void SetEffects(const PlantEffects& effects) { setup_.effects = effects; }
  /// Turns the instrument about its own axis.
  void SetRoll(double roll_rad) { setup_.roll_rad = roll_rad; }

 private:
  struct Call;  // what one call of Solve works on
  static bool SolveNear(const ChainProblem& problem, ChainState& state, int& iterations);
  bool SolveCold(Call& call) const;
  bool SolveWithMemory(Call& call) const;
  void FillShape(const Call& call, PlantShape& shape) const;
  void FillPort(const Call& call, PlantShape& shape) const;
  void FillMoments(const Call& call, const ChainRest& rest, PlantShape& shape) const;
  void FillFrames(const Call& call, const ChainRest& rest, PlantShape& shape) const;

  PlantSetup setup_;
  PlantOptions options_;
  bool warm_ = false;
  ChainState state_;
  PlantMemory memory_;
};

}  // namespace flextip::simulation
