// Where a board's corners truly are: prints are scaled and sheets are bent.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include "calibration/camera/solution.h"

namespace flextip {

/// Adjusts lens, warp and poses together with every corner's place on the board (Strobl and
/// Hirzinger, ICCV Workshops 2008, free the corners in the same way), each coordinate held to the
/// description by `sd_m`, which also keeps the board's size. Without `sd_m` it is the scatter that
/// the views themselves show (empirical Bayes, by expectation and maximisation). Starts from
/// `solution.shape`. False where an adjustment fails; `solution` is then as it was.
bool EstimateBoardShape(CameraSolution& solution, std::optional<double> sd_m = {});

/// The same of any `solution` with `noise_px` and `shape` that `adjust` moves and evaluates:
/// repeated until noise and, without `sd_m`, scatter have settled. `start_sd_m` is where the
/// scatter starts.
template <class Solution, class Adjust>
bool SettleBoardShape(Solution& solution, std::optional<double> sd_m, double start_sd_m,
                      const Adjust& adjust) {
  constexpr int kRounds = 40;
  constexpr double kSettled = 0.02;  // from one round to the next
  const auto near = [](double a, double b) { return std::abs(a - b) <= kSettled * b; };
  Solution s = solution;
  s.shape.sd_m = sd_m.value_or(start_sd_m);
  for (int round = 0; round < kRounds; ++round) {
    if (!(s.noise_px > 0 && s.shape.sd_m > 0)) return false;  // nothing to be explained
    const double noise_px = s.noise_px, before_m = s.shape.sd_m;
    if (!adjust(s)) return false;
    if (!sd_m) s.shape.sd_m = s.shape.scatter_m;
    if (near(s.noise_px, noise_px) && near(s.shape.sd_m, before_m)) break;
  }
  solution = std::move(s);
  return true;
}

/// The root of the mean squared length of the offsets (m), and the longest.
std::pair<double, double> SizeOf(const BoardShape& shape);

}  // namespace flextip
