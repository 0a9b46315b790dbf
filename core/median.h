// Medians and quantiles of some numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace flextip {

/// Returns the median of `values`; of an even number of them the larger of the two in the middle.
/// Returns 0 where there are none.
template <class T>
T Median(std::vector<T> values) {
  if (values.empty()) return T{};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Returns the median of `values`, as above, and allocates nothing.
template <class T, std::size_t N>
T Median(std::array<T, N> values) {
  std::nth_element(values.begin(), values.begin() + N / 2, values.end());
  return values[N / 2];
}

/// Returns the member of `values` at the rank floor(q (n - 1)), not interpolated: for `q` = 0 the
/// least, for 1 the largest. Returns 0 where there are none.
template <class T>
T LowerQuantile(std::vector<T> values, double q) {
  if (values.empty()) return T{};
  const double last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::clamp(q, 0.0, 1.0) * last);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Returns the value below which the share `q` (0 .. 1) of `values` lies, interpolated linearly
/// between neighbours: 0 gives the least, 1 the largest. Returns 0 where there are none.
inline double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = std::clamp(q, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(at));
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

}  // namespace flextip
