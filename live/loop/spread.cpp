#include "live/loop/spread.h"

#include <algorithm>
#include <cmath>

namespace flextip::live {
namespace {

constexpr double kStep_s = 1e-6;

}  // namespace

void Spread::Add(TimeNs duration_ns) {
  const double duration_s = 1e-9 * static_cast<double>(std::max<TimeNs>(duration_ns, 0));
  const auto step = static_cast<std::size_t>(duration_s / kStep_s);
  ++counts_[std::min(step, kSteps - 1)];
  ++count_;
  worst_s_ = std::max(worst_s_, duration_s);
}

double Spread::Quantile_s(double part) const {
  const auto wanted = static_cast<long>(std::ceil(part * static_cast<double>(count_)));
  long below = 0;
  for (std::size_t i = 0; i < kSteps && count_ > 0; ++i) {
    below += counts_[i];
    if (below >= wanted) return std::min(static_cast<double>(i + 1) * kStep_s, worst_s_);
  }
  return worst_s_;
}

long Spread::Between(double from_s, double to_s) const {
  const auto from = static_cast<std::size_t>(std::llround(from_s / kStep_s));
  const auto to = std::min(static_cast<std::size_t>(std::llround(to_s / kStep_s)), kSteps);
  long count = 0;
  for (std::size_t i = from; i < to; ++i) count += counts_[i];
  return count;
}

}  // namespace flextip::live
