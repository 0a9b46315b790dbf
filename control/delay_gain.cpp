#include "control/delay_gain.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

constexpr double kMargin = 0.95;  // of the small gain

/// Returns the largest |T| (E + (1 + E) |z^-m - 1|) over the circle and over 0 <= m <= cycles.
double LoopSize(double gain, double cycles, double model_error) {
  constexpr int kPlaces = 720;
  double largest = 0.0;
  for (int i = 0; i <= kPlaces; ++i) {
    const double angle = M_PI * i / kPlaces;
    const double T = gain / std::sqrt(gain * gain + 2.0 * (1.0 - gain) * (1.0 - std::cos(angle)));
    const double turned = 2.0 * std::sin(0.5 * std::min(angle * cycles, M_PI));
    largest = std::max(largest, T * (model_error + (1.0 + model_error) * turned));
  }
  return largest;
}

}  // namespace

double GainUnderDelay(double gain, const DelayUncertainty& delay) {
  const double cycles = delay.deviations * delay.sd_s * delay.rate_hz;
  if (!(cycles > 0.0)) return gain;
  double low = 0.0, high = std::min(gain, 1.0);
  if (LoopSize(high, cycles, delay.model_error) <= kMargin) return high;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (LoopSize(middle, cycles, delay.model_error) <= kMargin ? low : high) = middle;
  }
  return low;
}

}  // namespace flextip
