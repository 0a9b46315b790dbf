// The cold start of a rod: loads grow from nothing, so that the equilibrium is the one connected to
// the straight shaft.
#pragma once

#include <algorithm>

namespace flextip {

/// Solves with a growing part (0 to 1) of a scaled load of size `load`. `guess(part)` starts the
/// first solve. `newton(part, x)` improves `x` and returns its iterations, or 0 where it failed;
/// the step is then halved. Returns the iterations of all solves, counting `failed` for each that
/// failed; 0 where the full load was not reached, with `x` undefined.
template <class Unknowns, class Guess, class Newton>
int InLoadSteps(double load, int failed, Unknowns& x, Guess guess, Newton newton) {
  constexpr int kMaxLoadSteps = 60;
  constexpr double kLoadStep = 0.7, kLeastStep = 1e-4, kRounding = 1e-9;
  double done = 0.0, step = load > kLoadStep ? kLoadStep / load : 1.0;
  int iterations = 0;
  Unknowns at_done = guess(0.0);
  for (int i = 0; i < kMaxLoadSteps && step > kLeastStep; ++i) {
    // Steps never grow: where those left cannot reach the load, none of them is worth its time.
    if (done + (kMaxLoadSteps - i) * step < 1.0 - kRounding) return 0;
    const double next = std::min(1.0, done + step);
    x = done == 0.0 ? guess(next) : at_done;
    const int used = newton(next, x);
    iterations += used > 0 ? used : failed;
    if (used == 0) {
      step *= 0.5;
      continue;
    }
    if (next == 1.0) return iterations;
    at_done = x;
    done = next;
  }
  return 0;
}

}  // namespace flextip
