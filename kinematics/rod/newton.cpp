// Newton's iteration of the rod, by an older inverse as far as that does well.
#include <cmath>

#include "kinematics/rod/conditions.h"

namespace flextip {
namespace {

constexpr double kConverged = 1e-12;   // of the scaled conditions
constexpr double kNearlyThere = 1e-9;  // from here one linear correction reaches rounding error
constexpr double kMaxLinear = 1e-7;    // largest change of the unknowns such a correction may make
constexpr double kExpected = 1e-10;    // a residual expected below this one is the last
constexpr double kNearStart = 1e-2;    // largest residual that an older derivative may correct
constexpr double kBetter = 0.03;       // by which what is learned from one step helps, at least
constexpr double kGoodRate = 0.3;      // and the least that it has to take off each time

}  // namespace

int RodSolver::Newton(const Scaled& scaled, const Start& start, Unknowns& x, Evaluation& e) {
  // The derivatives cost several walks without. So an older inverse takes the residual down as far
  // as it does well, and they come when the residual is expected to be small.
  bool near = start.near;
  double last = 1e300, expected = start.same ? 0.0 : 1.0, rate = 0.0;
  Vector6 dx = Vector6::Zero(), last_residual = Vector6::Zero();
  e.corrected.setZero();
  for (int i = 1; i <= kMaxNewton; ++i) {
    // Not where four walks would not do. (The rate itself gets better.)
    const double fourth = i == 2 ? rate * rate * kBetter : i == 3 ? rate : 1.0;
    const bool full = !near || expected < kExpected || (i > 1 && fourth * expected > kExpected);
    Evaluate(scaled, x, full, e);
    if (!e.ok) return 0;
    const double size = e.residual.norm();
    if (full && size < kConverged) return i;
    if (!full && size > (i == 1 ? kNearStart : kGoodRate * last)) {
      near = false;  // it no longer does well
      continue;
    }
    if (full && i > 4 && size > 0.9 * last) return 0;  // it should converge quadratically by now
    if (!full) {
      if (i > 1) e.Learn(dx, e.residual - last_residual);
      rate = i > 1 ? size / last : start.rate > 0 ? start.rate : 2.0 * size / start.moved;
      expected = rate * size;
    }
    last = size;
    last_residual = e.residual;
    dx = -(e.inverse * e.residual);
    if (!dx.allFinite()) return 0;
    const double turn = dx.head<2>().norm();
    if (turn > kMaxTurn) dx *= kMaxTurn / turn;
    // The port stays on the shaft: at most half of the way to either end in one step.
    const double room = 0.5 * (dx[kPlace] > 0 ? 1.0 - x.sigma_port : x.sigma_port);
    if (std::abs(dx[kPlace]) > room) dx *= room / std::abs(dx[kPlace]);
    e.corrected += dx;
    const bool done = full && size < kNearlyThere && dx.norm() < kMaxLinear;
    if (done) e.Correct(dx);
    x.Move(dx);
    if (x.sigma_port < kMinStretch || x.sigma_port > 1.0 - kMinStretch) return 0;
    if (done) return i;
  }
  return 0;
}

}  // namespace flextip
