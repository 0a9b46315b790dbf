#include "recording/resample.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

double PeriodNs(double rate_hz) { return 1e9 / rate_hz; }

/// The neighbours of `t_ns`; empty outside the series and inside a gap.
template <class T>
std::optional<Bracket> Neighbours(const Series<T>& series, double rate_hz, TimeNs t_ns,
                                  const ResampleOptions& options) {
  const auto where = FindBracket(series, t_ns);
  if (!where || where->fraction == 0.0) return where;
  const auto gap = static_cast<double>(series[where->i + 1].t_ns - series[where->i].t_ns);
  if (gap > options.max_gap_periods * PeriodNs(rate_hz)) return {};
  return where;
}

/// `blend(before, after, fraction)` of the neighbours, or the sample itself at its own time.
template <class T, class Blend>
std::optional<T> Lookup(const Series<T>& series, double rate_hz, TimeNs t_ns,
                        const ResampleOptions& options, Blend blend) {
  const auto where = Neighbours(series, rate_hz, t_ns, options);
  if (!where) return {};
  if (where->fraction == 0.0) return series[where->i].value;
  return blend(series[where->i].value, series[where->i + 1].value, where->fraction);
}

template <class V>
V Linear(const V& a, const V& b, double u) {
  return a + u * (b - a);
}

}  // namespace

std::optional<WristSample> WristAt(const WristStream& stream, TimeNs t_ns,
                                   const ResampleOptions& options) {
  return Lookup(stream.samples, stream.rate_hz, t_ns, options,
                [](const WristSample& a, const WristSample& b, double u) {
                  WristSample at{Interpolate(a.p_RW, b.p_RW, u), {}};
                  if (a.q_RW && b.q_RW) at.q_RW = Interpolate(*a.q_RW, *b.q_RW, u);
                  return at;
                });
}

std::optional<EmSample> EmAt(const EmStream& stream, TimeNs t_ns, const ResampleOptions& options) {
  return Lookup(stream.samples, stream.rate_hz, t_ns, options,
                [](const EmSample& a, const EmSample& b, double u) {
                  return EmSample{Interpolate(a.p_RS, b.p_RS, u), Interpolate(a.q_RS, b.q_RS, u)};
                });
}

std::optional<Eigen::Vector4d> StrainAt(const StrainStream& stream, TimeNs t_ns,
                                        const ResampleOptions& options) {
  return Lookup(stream.moments_Nm, stream.rate_hz, t_ns, options, Linear<Eigen::Vector4d>);
}

std::optional<Eigen::Vector3d> LoadAt(const LoadStream& stream, TimeNs t_ns,
                                      const ResampleOptions& options) {
  return Lookup(stream.f_tip_N, stream.rate_hz, t_ns, options, Linear<Eigen::Vector3d>);
}

std::optional<Sample<TipObservation>> TipAt(const VisionStream& stream, TimeNs t_ns) {
  const auto& tips = stream.tips;
  const auto after = std::lower_bound(
      tips.begin(), tips.end(), t_ns,
      [](const Sample<TipObservation>& sample, TimeNs t) { return sample.t_ns < t; });
  const auto distance = [&](auto it) { return std::abs(static_cast<double>(it->t_ns - t_ns)); };
  auto nearest = after;
  if (after != tips.begin() && (after == tips.end() || distance(after - 1) < distance(after))) {
    --nearest;
  }
  if (nearest == tips.end() || distance(nearest) > 0.5 * PeriodNs(stream.rate_hz)) return {};
  return *nearest;
}

}  // namespace flextip
