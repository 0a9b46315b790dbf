#include "calibration/camera/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/camera/bundle.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr int kRounds = 12;
// The median of the length of a vector of two normal coordinates, in standard deviations.
constexpr double kMedianOfNormal = 1.17741;
// Corners better than this are never told apart from each other: pictures are not that good.
constexpr double kLeastNoise_px = 1e-3;

std::vector<double> Distances(const SolvedView& view) {
  std::vector<double> d;
  for (const Eigen::Vector2d& r : view.residual_px) d.push_back(r.norm());
  return d;
}

double MedianNoise(const CameraSolution& s) {
  std::vector<double> d;
  for (const SolvedView& view : s.views) {
    const auto of_view = Distances(view);
    d.insert(d.end(), of_view.begin(), of_view.end());
  }
  return std::max(kLeastNoise_px, Median(d) / kMedianOfNormal);
}

// Whether any corner changed sides.
bool MarkCorners(double limit_px, double noise_px, CameraSolution& s) {
  bool changed = false;
  for (SolvedView& view : s.views) {
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      const double off_px = view.residual_px[i].norm();
      const bool used = off_px <= limit_px;
      changed |= used != view.IsUsed(i);
      view.reason[i] = used ? std::string()
                            : fmt::format(
                                  "{:.3f} px off, more than {:.3f} px ({:.3g} times the "
                                  "noise)",
                                  off_px, limit_px, limit_px / noise_px);
    }
  }
  return changed;
}

// Why the view is bad; nothing where it is not.
std::optional<std::string> Fault(const SolvedView& view, double median_px,
                                 const OutlierRule& rule) {
  const double own_px = Median(Distances(view)), limit_px = rule.view_ratio * median_px;
  if (own_px > limit_px) {
    return fmt::format(
        "its corners are {:.3f} px off in the median, more than {:.3f} px ({} times "
        "that of all views)",
        own_px, limit_px, rule.view_ratio);
  }
  const int all = static_cast<int>(view.px.size()), out = all - view.CountUsed();
  if (out > rule.view_share * all) {
    return fmt::format("{} of its {} corners are outliers", out, all);
  }
  return {};
}

// Takes out the worst view, where it is bad.
bool RejectView(const OutlierRule& rule, CameraSolution& s, std::vector<RejectedView>& rejected) {
  if (static_cast<int>(s.views.size()) <= rule.min_views) return false;
  const double median_px = std::max(kLeastNoise_px, MedianNoise(s) * kMedianOfNormal);
  const auto worst = std::max_element(s.views.begin(), s.views.end(),
                                      [](const SolvedView& a, const SolvedView& b) {
                                        return Median(Distances(a)) < Median(Distances(b));
                                      });
  for (auto view = s.views.begin(); view != s.views.end(); ++view) {
    const auto fault = Fault(*view, median_px, rule);
    if (!fault || (view != worst && Fault(*worst, median_px, rule))) continue;
    rejected.push_back({view->index, *fault});
    s.views.erase(view);
    return true;
  }
  return false;
}

}  // namespace

bool RejectOutliers(CameraSolution& s, const OutlierRule& rule,
                    std::vector<RejectedView>& rejected) {
  double noise_px = MedianNoise(s);
  for (int round = 0; round < kRounds; ++round) {
    if (round == 0) {
      const BundleOptions robust{.estimate_warp = rule.estimate_warp, .cauchy_px = 2.0 * noise_px};
      if (!AdjustBundle(s, robust)) return false;
      noise_px = MedianNoise(s);
    } else {
      if (!AdjustBundle(s, {.estimate_warp = rule.estimate_warp})) return false;
      noise_px = std::max(kLeastNoise_px, s.noise_px);
    }
    bool changed = MarkCorners(rule.corner_ratio * noise_px, noise_px, s);
    while (RejectView(rule, s, rejected)) changed = true;
    if (!changed && round > 0) return true;
  }
  return AdjustBundle(s, {.estimate_warp = rule.estimate_warp});
}

}  // namespace flextip
