#include "simulation/plant/friction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "simulation/plant/chain_geometry.h"
#include "simulation/plant/chain_port.h"

namespace flextip::simulation {
namespace {

using Mode = ChainFriction::Mode;

struct Trial {
  Mode mode;
  double sign;  // of the slip
};

/// Friction that sticks between `anchor` and s would be this; the bound at the same state.
double Stretched(const ChainFriction& friction, double anchor, const ChainState& state) {
  return friction.stiffness * (state.s - anchor);
}

double Bound(const ChainProblem& problem, const ChainState& state) {
  const double lateral =
      Lateral(state.r, HingeOf(problem, ChainGeometry(problem, state.s), state).tangent).norm();
  return FrictionBound(problem.friction, state.s, lateral);
}

/// By how much a solved trial contradicts itself, as a force: a stick beyond the bound, or a slip
/// to the side the shaft did not go. Not positive: it holds.
double Contradiction(const ChainProblem& problem, const Trial& trial, double anchor,
                     const ChainState& state) {
  const double stretched = Stretched(problem.friction, anchor, state);
  const double bound = Bound(problem, state);
  const double slack = 1e-9 * (1.0 + bound);
  if (trial.mode == Mode::kStick) return std::abs(stretched) - bound - slack;
  return bound - trial.sign * stretched - slack;
}

/// The likely one first: a long way is a slip to that side, a short one goes on sticking.
std::array<Trial, 3> Trials(double way) {
  constexpr double kShort = 1e-5;
  const double sign = way < 0 ? -1.0 : 1.0;
  const Trial stick{Mode::kStick, 0.0}, ahead{Mode::kSlip, sign}, back{Mode::kSlip, -sign};
  if (std::abs(way) > kShort) return {ahead, stick, back};
  return {stick, ahead, back};
}

}  // namespace

bool SolveWithFriction(ChainProblem& problem, ChainState& state,
                       std::optional<FrictionMemory>& memory, const ChainSolve& solve) {
  ChainFriction& friction = problem.friction;
  const double chord = (problem.p_port - TrueWrist(problem, state)).norm();
  if (!memory) {
    friction.mode = Mode::kNone;
    if (!solve(problem, state)) return false;
    memory = FrictionMemory{state.s, chord};
    return true;
  }
  const double anchor = memory->anchor;
  double least = std::numeric_limits<double>::infinity();
  std::optional<ChainState> best;
  ChainFriction held;
  for (const Trial& trial : Trials(chord - memory->chord)) {
    friction.mode = trial.mode;
    friction.sign = trial.sign;
    friction.anchor = anchor;
    ChainState tried = state;
    if (!solve(problem, tried)) continue;
    const double wrong = Contradiction(problem, trial, anchor, tried);
    if (wrong < least) {
      least = wrong;
      best = std::move(tried);
      held = friction;
    }
    if (wrong <= 0) break;
  }
  if (!best || least > 0.1 * Bound(problem, *best)) {
    // The shaft snaps to another place, or is free there: whatever held has let go.
    friction.mode = Mode::kNone;
    if (!solve(problem, state)) return false;
    memory = FrictionMemory{state.s, chord};
    return true;
  }
  state = std::move(*best);
  friction = held;
  if (held.mode == Mode::kSlip) {
    memory->anchor = state.s - held.sign * Bound(problem, state) / held.stiffness;
  }
  memory->chord = chord;
  return true;
}

}  // namespace flextip::simulation
