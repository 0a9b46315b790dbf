// Time-stamped samples and their interpolation.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace flextip {

using TimeNs = std::int64_t;

template <class T>
struct Sample {
  TimeNs t_ns = 0;
  T value{};
  bool operator==(const Sample&) const = default;
};

/// Visits a sample as a part of a saved state (state_text.h).
template <class T, class State>
void VisitState(Sample<T>& sample, State& state) {
  state(sample.t_ns);
  state(sample.value);
}

/// How much later than it was taken a sample is stamped, or arrives.
struct Latency {
  double value_s = 0.0, sd_s = 0.0;
};

/// Samples in strictly increasing time.
template <class T>
using Series = std::vector<Sample<T>>;

/// Where time `t_ns` falls in a series: between samples `i` and `i + 1`, at `fraction` of the way.
struct Bracket {
  std::size_t i = 0;
  double fraction = 0.0;
};

/// Returns the samples around `t_ns`; empty outside the series: nothing is extrapolated.
template <class T>
std::optional<Bracket> FindBracket(const Series<T>& series, TimeNs t_ns) {
  if (series.empty() || t_ns < series.front().t_ns || t_ns > series.back().t_ns) return {};
  const auto after = std::upper_bound(series.begin(), series.end(), t_ns,
                                      [](TimeNs t, const Sample<T>& s) { return t < s.t_ns; });
  const auto i = static_cast<std::size_t>(after - series.begin()) - 1;
  if (after == series.end()) return Bracket{i, 0.0};
  const double span = static_cast<double>(after->t_ns - series[i].t_ns);
  return Bracket{i, static_cast<double>(t_ns - series[i].t_ns) / span};
}

inline Eigen::Vector3d Interpolate(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double u) {
  return a + u * (b - a);
}
inline Eigen::Quaterniond Interpolate(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b,
                                      double u) {
  return a.slerp(u, b);
}

/// The series' value at `t_ns`, interpolated by the `Interpolate` of its type; empty outside.
template <class T>
std::optional<T> ValueAt(const Series<T>& series, TimeNs t_ns) {
  const auto where = FindBracket(series, t_ns);
  if (!where) return {};
  if (where->fraction == 0.0) return series[where->i].value;
  return Interpolate(series[where->i].value, series[where->i + 1].value, where->fraction);
}

}  // namespace flextip
