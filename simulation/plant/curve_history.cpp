#include "simulation/plant/curve_history.h"

#include <cmath>
#include <utility>

#include "core/check.h"

namespace flextip::simulation {
namespace {

ShaftCurve Between(const ShaftCurve& a, const ShaftCurve& b, double u) {
  ShaftCurve curve = a;
  for (std::size_t i = 0; i < a.points.size(); ++i)
    curve.points[i] = Interpolate(a.points[i], b.points[i], u);
  curve.T_RE = {Interpolate(a.T_RE.Quaternion(), b.T_RE.Quaternion(), u).toRotationMatrix(),
                Interpolate(a.T_RE.p, b.T_RE.p, u)};
  return curve;
}

}  // namespace

CurveHistory::CurveHistory(double seconds) : span_ns_(std::llround(1e9 * seconds)) {}

void CurveHistory::Add(TimeNs t_ns, ShaftCurve curve) {
  if (!entries_.empty()) {
    FLEXTIP_CHECK(curve.points.size() == entries_.back().value.points.size(),
                  "curves of a history have as many points");
    if (entries_.back().t_ns == t_ns) entries_.pop_back();
  }
  entries_.push_back({t_ns, std::move(curve)});
  while (entries_.size() > 1 && entries_[1].t_ns <= t_ns - span_ns_) entries_.pop_front();
}

ShaftCurve CurveHistory::Before(TimeNs t_ns) const {
  const TimeNs then_ns = t_ns - span_ns_;
  FLEXTIP_CHECK(!entries_.empty(), "a history has a curve");
  for (std::size_t i = entries_.size(); i-- > 0;) {
    const auto& [a_ns, a] = entries_[i];
    if (a_ns > then_ns && i > 0) continue;
    if (a_ns >= then_ns || i + 1 == entries_.size()) return a;
    const auto& [b_ns, b] = entries_[i + 1];
    return Between(a, b, static_cast<double>(then_ns - a_ns) / static_cast<double>(b_ns - a_ns));
  }
  return entries_.front().value;
}

}  // namespace flextip::simulation
