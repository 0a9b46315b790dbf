// Of single streams, as the samples are made of them: which readings are taken and when, and
// whether they say anything.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/time_series.h"

namespace flextip::diagnosis {

/// A stream's samples, thinned by a whole number to no less than 0.8 times `rate_hz` where they
/// come faster than that allows.
template <class T>
Series<T> Thinned(const Series<T>& all, double rate_hz) {
  if (all.size() < 2) return all;
  const double span_s = double(all.back().t_ns - all.front().t_ns) * 1e-9;
  const double own_rate_hz = double(all.size() - 1) / span_s;
  const auto stride = std::size_t(std::max(1.0, std::floor(own_rate_hz / (0.8 * rate_hz))));
  Series<T> kept;
  for (std::size_t i = 0; i < all.size(); i += stride) kept.push_back(all[i]);
  return kept;
}

/// For each of `times` the index of the stream's sample nearest to it, within half a period; -1 for
/// none. A sample belongs to one time only.
template <class T>
std::vector<long> Nearest(const Series<T>& series, const std::vector<TimeNs>& times,
                          TimeNs half_period_ns) {
  std::vector<long> nearest(times.size(), -1);
  for (std::size_t j = 0; j < series.size(); ++j) {
    const TimeNs t = series[j].t_ns;
    const auto after = std::lower_bound(times.begin(), times.end(), t);
    auto k = std::size_t(after - times.begin());
    if (k == times.size() || (k > 0 && t - times[k - 1] < times[k] - t)) --k;
    const TimeNs distance = std::abs(t - times[k]);
    if (distance > half_period_ns) continue;
    const long other = nearest[k];
    if (other < 0 || distance < std::abs(series[other].t_ns - times[k])) nearest[k] = long(j);
  }
  return nearest;
}

/// Whether a value never changes.
template <class T, class Get>
bool IsDead(const Series<T>& series, Get get) {
  if (series.size() < 2) return false;
  const auto first = get(series.front().value);
  return std::all_of(series.begin(), series.end(),
                     [&](const auto& s) { return get(s.value) == first; });
}

/// Which part of the readings says exactly the largest or the smallest value there is, where that
/// is no coincidence: a sensor at its limit. Else zero.
template <class T, class Get>
double PartAtLimit(const Series<T>& series, Get get) {
  constexpr double kCoincidence = 0.02;
  if (series.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(
      series.begin(), series.end(),
      [&](const auto& a, const auto& b) { return get(a.value) < get(b.value); });
  const double lowest = get(low->value), highest = get(high->value);
  const auto count = std::count_if(series.begin(), series.end(), [&](const auto& s) {
    return get(s.value) == lowest || get(s.value) == highest;
  });
  const double part = double(count) / double(series.size());
  return count > 4 && part > kCoincidence ? part : 0.0;
}

}  // namespace flextip::diagnosis
