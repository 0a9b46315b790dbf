#include "calibration/verdict/em.h"

#include <fmt/format.h>

#include <cmath>

namespace flextip {
namespace {

constexpr double kManyOutliers = 0.1;  // of the samples
constexpr double kNoisier = 2.0;       // than stated
constexpr double kSureLag = 5.0;       // standard deviations

const EmCandidate* Chosen(const EmResult& r) {
  for (const EmCandidate& c : r.candidates) {
    if (c.chosen) return &c;
  }
  return nullptr;
}

void AddReasons(const EmResult& r, CalibrationVerdict& verdict) {
  const std::string lag = LagText(r);
  if (!lag.empty()) {
    verdict.Beware(lag);
    verdict.next = "bring the clocks of sensor and reference together";
    verdict.command = "flextip align RECORDING -o RESULT-clocks";
  }
  if (r.noise_scale > kNoisier) {
    verdict.Beware(
        fmt::format("the samples scatter {:.1f} times as much as sensor and reference "
                    "state: a bent field that was not found, or a reference that is off",
                    r.noise_scale));
  }
  const auto outliers = r.residuals.size() - static_cast<std::size_t>(r.used);
  verdict.MentionCount(outliers, static_cast<double>(r.residuals.size()), kManyOutliers,
                       Counted(outliers, "sample") + " did not agree and do not count");
}

void AddValues(const EmResult& r, CalibrationVerdict& verdict) {
  const Eigen::VectorXd sd = r.solution.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  verdict.Add("EM system in R, em0.T_RF", PlaceText(r.solution.T_RF.p),
              fmt::format("{:.2f} mm and {:.3f}°", 1e3 * sd.segment<3>(3).norm(),
                          180.0 / M_PI * sd.head<3>().norm()));
  const std::string distance = fmt::format("{:.2f} mm", 1e3 * r.solution.distance_m);
  if (r.design.free_distance) {
    verdict.Add("sensor to tip", distance, fmt::format("{:.2f} mm", 1e3 * sd[6]));
  } else {
    verdict.Add("sensor to tip", distance + ", as supposed");
  }
  if (const EmCandidate* c = Chosen(r)) {
    verdict.Add("field", c->name);
    verdict.Add("parts of space held out",
                fmt::format("{:.3f} mm an axis", 1e3 * c->heldout_rms_m));
  }
  verdict.Add("residual an axis", fmt::format("{:.3f} mm RMS", 1e3 * r.rms_after_m));
  verdict.Add("noise found over stated", fmt::format("{:.2f}", r.noise_scale));
  verdict.Add("samples used", fmt::format("{} of {}", r.used, r.residuals.size()));
}

}  // namespace

std::string LagText(const EmResult& r) {
  if (std::abs(r.lag.late_s) <= kSureLag * r.lag.sd_s) return {};
  return fmt::format(
      "the sensor is {:.1f} ms {} the reference (standard deviation {:.1f} ms): their clocks or "
      "filters differ, and what is found is worse for it",
      1e3 * std::abs(r.lag.late_s), r.lag.late_s > 0 ? "behind" : "ahead of", 1e3 * r.lag.sd_s);
}

CalibrationVerdict JudgeEm(const EmResult& r) {
  CalibrationVerdict verdict;
  verdict.not_found = r.unobservable;
  if (!r.unobservable.empty()) {
    verdict.next = "move the sensor through more of the space it will work in, in all directions";
  }
  if (!r.IsUsable()) {
    verdict.grade = Grade::kNotFound;
    verdict.says = "These samples do not tell where the EM system is.";
    if (!r.message.empty()) verdict.reasons.push_back(r.message);
    return verdict;
  }
  AddReasons(r, verdict);
  const Eigen::VectorXd sd = r.solution.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const EmCandidate* chosen = Chosen(r);
  verdict.says = fmt::format(
      "{} The EM system's place is known to {:.2f} mm; where it was not fitted it is {:.2f} mm off "
      "along each axis.",
      verdict.Judged(), 1e3 * sd.segment<3>(3).norm(),
      1e3 * (chosen ? chosen->heldout_rms_m : r.rms_after_m));
  AddValues(r, verdict);
  verdict.AdviseUse(
      "the commands on what this EM system records",
      "flextip estimate RECORDING --calibration RESULT/calibration.yaml -o RESULT-estimate");
  return verdict;
}

}  // namespace flextip
