// Small statistics of the studies of chapter 2. Private to reproduction.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/median.h"
#include "workspace/map.h"
#include "workspace/planar_instrument.h"

namespace flextip::reproduction {

inline constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;

inline double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / double(values.size());
}
/// As LowerQuantile, but NaN of none, which is no number.
inline double QuantileOrNan(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return LowerQuantile(std::move(values), share);
}

/// Of the points with both measures that `where` holds for, the share that `what` holds for.
template <class Where, class What>
double ShareOf(const WorkspaceMap<2>& map, Where where, What what) {
  int all = 0, some = 0;
  for (const auto& at : map.points) {
    if (!at.A || !where(at)) continue;
    ++all;
    some += what(at) ? 1 : 0;
  }
  return all > 0 ? double(some) / all : std::numeric_limits<double>::quiet_NaN();
}
template <class What>
double ShareOf(const WorkspaceMap<2>& map, What what) {
  return ShareOf(
      map, [](const auto&) { return true; }, what);
}
/// `value` of every point with both measures that `where` holds for.
template <class Where, class Value>
std::vector<double> Collect(const WorkspaceMap<2>& map, Where where, Value value) {
  std::vector<double> values;
  for (const auto& at : map.points)
    if (at.A && where(at)) values.push_back(value(at));
  return values;
}

/// Between two directions whose sign means nothing (deg).
inline double AngleBetweenLines(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return kDegreesPerRad * std::atan2(std::abs(a.x() * b.y() - a.y() * b.x()), std::abs(a.dot(b)));
}
/// Direction from the true port to the tip, above z (deg).
inline double BearingDeg(const PointMeasures<2>& at) {
  const Eigen::Vector2d from = at.p_tip - PlanarInstrument{}.p_port;
  return kDegreesPerRad * std::atan2(from.y(), from.x());
}

}  // namespace flextip::reproduction
