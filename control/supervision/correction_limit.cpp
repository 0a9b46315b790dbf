#include "control/supervision/correction_limit.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

constexpr double kStands_m = 1e-9;

/// The largest part of `v`, at most all, with which `before` and `v` together are no longer than
/// `most_m`, or than `before` is.
double PartWithin(const Eigen::Vector3d& before, const Eigen::Vector3d& v, double most_m) {
  const double most2 = std::max(most_m * most_m, before.squaredNorm());
  if (!((before + v).squaredNorm() > most2)) return 1.0;
  const double v2 = v.squaredNorm(), by = before.dot(v);
  const double root = std::sqrt(std::max(0.0, by * by + v2 * (most2 - before.squaredNorm())));
  return std::clamp((root - by) / v2, 0.0, 1.0);
}

}  // namespace

CorrectionLimit::CorrectionLimit(double rate_hz)
    : keeps_(1.0 - std::min(1.0, kVideo_hz / rate_hz)) {}

Limited CorrectionLimit::Limit(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_wish,
                               const Eigen::Matrix3d& J, const Eigen::Vector3d& way,
                               const CorrectionLimits& limits) {
  const Eigen::Vector3d step = p_wish - p_RW, dp_RE = J * step;
  if (!dp_RE.allFinite()) return {p_wish, false};
  const double way_m = way.norm();
  const Eigen::Vector3d u =
      way_m > kStands_m ? Eigen::Vector3d(way / way_m) : Eigen::Vector3d::Zero();
  const double along_m = dp_RE.dot(u), before_m = corrected_m_.dot(u);
  const Eigen::Vector3d across = dp_RE - along_m * u;
  const double of_across = PartWithin(corrected_m_ - before_m * u, across, limits.across_m);
  const double most_m = std::max(0.0, way_m + limits.along_m - before_m);
  const double least_m = std::min(0.0, -way_m - limits.along_m - before_m);
  const double kept_m = std::clamp(along_m, least_m, most_m);
  const bool limited = of_across < 1.0 || kept_m != along_m;
  Eigen::Vector3d kept = kept_m * u + of_across * across, p = p_wish;
  if (limited) {
    // A wrist that would go farther for less of the tip's way, by a Jacobian near a singular one.
    const Eigen::Vector3d less = J.fullPivLu().solve(kept);
    const bool is_less = less.allFinite() && less.norm() <= step.norm();
    const double part = std::min(of_across, kept_m == along_m ? 1.0 : kept_m / along_m);
    p = p_RW + (is_less ? less : Eigen::Vector3d(part * step));
    if (!is_less) kept = part * dp_RE;
  }
  const double of_goal_m = std::clamp(kept.dot(u), 0.0, way_m);
  corrected_m_ = keeps_ * (corrected_m_ + kept - of_goal_m * u);
  return {p, limited};
}

}  // namespace flextip
