// Coulomb friction at the port: stick where the friction it takes stays below the bound, otherwise
// slip. A return mapping around the chain's solve.
#pragma once

#include <functional>
#include <optional>

#include "simulation/plant/chain_problem.h"
#include "simulation/plant/memory.h"

namespace flextip::simulation {

/// The stiffness of what holds while sticking: 0.1 N of friction give way by 1 um.
inline constexpr double kStickStiffness_N_m = 1e5;

/// Improves a state to the equilibrium of the problem; false where there is none.
using ChainSolve = std::function<bool(const ChainProblem&, ChainState&)>;

/// Solves `problem`, whose friction states the bound's parameters and the stiffness, from `state`,
/// by `solve`. Without a memory there is no friction yet. Changes `problem`'s friction to what
/// held, and the memory; on failure the memory is what it was.
bool SolveWithFriction(ChainProblem& problem, ChainState& state,
                       std::optional<FrictionMemory>& memory, const ChainSolve& solve);

}  // namespace flextip::simulation
