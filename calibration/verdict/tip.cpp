#include "calibration/verdict/tip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/matrix_types.h"

namespace flextip {
namespace {

constexpr double kManyOutliers = 0.1;  // of the poses
constexpr double kNoisier = 2.0;       // than stated
constexpr double kMuchWorse = 1.5;     // held-out error over the one in sample

std::string SdText(const Eigen::Vector3d& sd_m) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", 1e3 * sd_m.x(), 1e3 * sd_m.y(), 1e3 * sd_m.z());
}

void AddReasons(const PivotResult& r, CalibrationVerdict& verdict) {
  const auto outliers = r.residuals.size() - static_cast<std::size_t>(r.used);
  verdict.MentionCount(
      outliers, static_cast<double>(r.residuals.size()), kManyOutliers,
      Counted(outliers, "pose") + " put the tip elsewhere and do not count (crosses below)");
  const double scale = std::max(r.position_noise_scale, r.orientation_noise_scale);
  if (scale > kNoisier) {
    verdict.Beware(
        fmt::format("the poses scatter {:.1f} times as much as the recording states: a "
                    "sensor worse than that, or a tip that moved in its divot",
                    scale));
  }
  if (r.heldout_rms_m > kMuchWorse * r.rms_m) {
    verdict.Beware("poses that were left out are predicted far worse than those fitted: too few");
  }
}

/// The name of an axis of the body where it is one of them, else its components.
std::string AxisName(const Eigen::Vector3d& axis) {
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis[i]) > 0.999) return std::string(1, "xyz"[i]);
  }
  return fmt::format("({:.2f} {:.2f} {:.2f})", axis.x(), axis.y(), axis.z());
}

}  // namespace

std::string AdviceText(const PivotResult& result, const std::string& body) {
  constexpr double kDeg = 180.0 / std::numbers::pi;
  const PivotAdvice& advice = result.advice;
  const double sd_m = std::sqrt(result.covariance.topLeftCorner<3, 3>().trace());
  const std::string turn =
      fmt::format("{} further poses turned by {:.0f} deg to both sides about the {} axis of {}",
                  advice.poses, kDeg * advice.angle_rad, AxisName(advice.axis_B), body);
  if (!std::isfinite(advice.sd_after_m)) return turn + " would help most";
  if (!result.IsUsable()) {
    return fmt::format("{} would give the tip to {:.3f} mm", turn, 1e3 * advice.sd_after_m);
  }
  return fmt::format("{} would lower the tip's standard deviation from {:.3f} to {:.3f} mm", turn,
                     1e3 * sd_m, 1e3 * advice.sd_after_m);
}

CalibrationVerdict JudgeTip(const PivotResult& r, const std::string& tip_name,
                            const std::string& body) {
  CalibrationVerdict verdict;
  if (!r.residuals.empty()) verdict.next = AdviceText(r, body);
  if (!r.IsUsable()) {
    verdict.grade = Grade::kNotFound;
    verdict.says = "These poses do not tell where the tip is.";
    verdict.not_found = {{tip_name, r.unobservable}, {"pivot.p_R", r.unobservable}};
    return verdict;
  }
  AddReasons(r, verdict);
  const Vector6d sd = r.covariance.diagonal().cwiseSqrt();
  verdict.says = fmt::format(
      "{} The tip is known to {:.2f} mm; a pose left out puts it {:.2f} mm off along each axis.",
      verdict.Judged(), 1e3 * sd.head<3>().norm(), 1e3 * r.heldout_rms_m);
  verdict.Add("tip in " + body + ", " + tip_name, PlaceText(r.p_BE), SdText(sd.head<3>()));
  verdict.Add("pivot in R, pivot.p_R", PlaceText(r.p_R), SdText(sd.tail<3>()));
  verdict.Add("residual an axis", fmt::format("{:.3f} mm RMS", 1e3 * r.rms_m));
  verdict.Add("each pose left out", fmt::format("{:.3f} mm RMS", 1e3 * r.heldout_rms_m));
  verdict.Add("noise found over stated",
              r.separate_noise ? fmt::format("position {:.2f}, orientation {:.2f}",
                                             r.position_noise_scale, r.orientation_noise_scale)
                               : fmt::format("{:.2f}", r.position_noise_scale));
  verdict.Add("poses used", fmt::format("{} of {}", r.used, r.residuals.size()));
  verdict.AdviseUse(
      "the commands on what this instrument records",
      "flextip estimate recording --calibration RESULT/calibration.yaml -o recording-estimate");
  return verdict;
}

}  // namespace flextip
