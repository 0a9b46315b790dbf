#include "recording/resample.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

std::optional<Eigen::Vector3d> CommandAt(const CommandStream& stream, TimeNs t_ns,
                                         const ResampleOptions& options) {
  const auto& series = stream.p_RW;
  const auto after = std::upper_bound(
      series.begin(), series.end(), t_ns,
      [](TimeNs t, const Sample<Eigen::Vector3d>& sample) { return t < sample.t_ns; });
  if (after == series.begin()) return {};
  const auto& last = *(after - 1);
  const auto age = static_cast<double>(t_ns - last.t_ns);
  if (age > options.max_gap_periods * PeriodNs(stream.rate_hz)) return {};
  return last.value;
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

std::optional<TimeSpan> CommonSpan(const Recording& recording) {
  TimeSpan span{std::numeric_limits<TimeNs>::min(), std::numeric_limits<TimeNs>::max()};
  bool any = false;
  const auto cut = [&](const auto& series) {
    if (series.empty()) return;
    any = true;
    span.first_ns = std::max(span.first_ns, series.front().t_ns);
    span.last_ns = std::min(span.last_ns, series.back().t_ns);
  };
  if (recording.wrist0) cut(recording.wrist0->samples);
  if (recording.command0) cut(recording.command0->p_RW);
  if (recording.em0) cut(recording.em0->samples);
  if (recording.em1) cut(recording.em1->samples);
  if (recording.strain0) cut(recording.strain0->moments_Nm);
  if (recording.load0) cut(recording.load0->f_tip_N);
  if (recording.vision0) cut(recording.vision0->tips);
  if (!any || span.first_ns > span.last_ns) return {};
  return span;
}

}  // namespace flextip
