#include "report/drawing/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flextip::report {
namespace {

/// Returns the least of 1, 2, 5 times a power of ten that is not below `about`.
double RoundStep(double about) {
  const double power = std::pow(10.0, std::floor(std::log10(about)));
  for (const double m : {1.0, 2.0, 5.0}) {
    if (m * power >= about * (1.0 - 1e-9)) return m * power;
  }
  return 10.0 * power;
}

}  // namespace

Axis::Axis(double low, double high, bool log) : low_(low), high_(high), log_(log) {
  if (!std::isfinite(low) || !std::isfinite(high) || (log && low <= 0.0)) {
    low_ = log ? 1.0 : 0.0;
    high_ = log ? 10.0 : 1.0;
  } else if (!(high > low)) {
    const double half = low == 0.0 ? 1.0 : 0.1 * std::abs(low);
    low_ = log ? low / 2.0 : low - half;
    high_ = log ? low * 2.0 : low + half;
  }
}

double Axis::Share(double value) const {
  if (log_) return std::log(value / low_) / std::log(high_ / low_);
  return (value - low_) / (high_ - low_);
}

std::vector<Tick> Axis::Ticks(int count) const {
  std::vector<Tick> ticks;
  if (log_) {
    const int first = static_cast<int>(std::ceil(std::log10(low_) - 1e-9));
    const int last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
    const int each = std::max(1, (last - first + count) / std::max(1, count));
    for (int p = first; p <= last; p += each) {
      ticks.push_back({std::pow(10.0, p), p >= -3 && p <= 3 ? fmt::format("{:g}", std::pow(10.0, p))
                                                            : fmt::format("1e{}", p)});
    }
    return ticks;
  }
  const double step = RoundStep((high_ - low_) / count);
  for (double k = std::ceil(low_ / step - 1e-9); k * step <= high_ + 1e-9 * step; k += 1.0) {
    ticks.push_back({k * step, fmt::format("{:.6g}", k == 0.0 ? 0.0 : k * step)});
  }
  return ticks;
}

void Axis::Widen(double factor) {
  const double middle = 0.5 * (low_ + high_), half = 0.5 * factor * (high_ - low_);
  low_ = middle - half;
  high_ = middle + half;
}

}  // namespace flextip::report
