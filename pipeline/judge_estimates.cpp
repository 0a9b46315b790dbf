#include "pipeline/judge_estimates.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/median.h"

namespace flextip {
namespace {

// Of chi-squared a measurement, 1 where the recording is as it says. A camera that stands 5 mm off
// leaves 500 times the noise of vision; a unit or a frame gone wrong leaves more.
constexpr double kDoubtful = 4.0, kAbsurd = 1e6;
constexpr double kFewFailed = 0.1;     // of all samples
constexpr double kManyTimesAlong = 5;  // a force along the shaft that is hardly known

void Count(EstimateStatus status, EstimateTotals& totals) {
  ++totals.samples;
  switch (status) {
    case EstimateStatus::kOk:
      ++totals.ok;
      break;
    case EstimateStatus::kUnobservable:
      ++totals.unobservable;
      break;
    case EstimateStatus::kNotConverged:
      ++totals.not_converged;
      break;
    case EstimateStatus::kBadInput:
      ++totals.bad_input;
      break;
  }
}

std::string Millimetres(double m) { return fmt::format("{:.2g} mm", 1e3 * m); }

Judgement NotFound(const std::string& says) {
  return {Grade::kNotFound,
          says,
          {},
          "find the stream that does not fit",
          "flextip check RECORDING -o RESULT-check"};
}

}  // namespace

EstimateTotals TotalsOf(const Series<ShaftEstimate>& estimates) {
  EstimateTotals totals;
  std::vector<double> tip, across, along;
  double chi2 = 0.0, measurements = 0.0;
  for (const auto& sample : estimates) {
    const ShaftEstimate& e = sample.value;
    Count(e.status, totals);
    chi2 += e.chi2;
    measurements += e.measurements;
    if (e.status != EstimateStatus::kOk) continue;
    const Eigen::Matrix3d force = e.covariance.bottomRightCorner<3, 3>();
    const double along_variance = e.d_RE.dot(force * e.d_RE);
    tip.push_back(std::sqrt(std::max(0.0, e.p_RE_covariance_m2.trace() / 3.0)));
    along.push_back(std::sqrt(std::max(0.0, along_variance)));
    across.push_back(std::sqrt(std::max(0.0, 0.5 * (force.trace() - along_variance))));
  }
  if (measurements > 0.0) totals.chi2_per_measurement = chi2 / measurements;
  totals.tip_sd_m = Median(tip);
  totals.force_across_sd_N = Median(across);
  totals.force_along_sd_N = Median(along);
  return totals;
}

Judgement JudgeEstimates(const EstimateTotals& t) {
  const int known = t.ok + t.unobservable;
  if (known == 0) {
    return NotFound(
        fmt::format("No sample could be estimated: of {} samples, {} did not converge "
                    "and {} have readings that are no numbers.",
                    t.samples, t.not_converged, t.bad_input));
  }
  const double misfit = std::sqrt(t.chi2_per_measurement);
  if (t.chi2_per_measurement > kAbsurd) {
    return NotFound(fmt::format(
        "The sensors contradict each other: the fit misses them by {:.0f} times their noise.",
        misfit));
  }
  Judgement judged;
  judged.says = t.ok > 0 ? fmt::format(
                               "Load, port and shape were found at {} of {} samples; the "
                               "tip is known to {} an axis by the stated noise.",
                               t.ok, t.samples, Millimetres(t.tip_sd_m))
                         : fmt::format(
                               "The sensors do not tell the load at any of {} samples: the "
                               "shaft is taken as unloaded.",
                               t.samples);
  judged.next = "take the states into other programs";
  judged.command = "flextip export csv RESULT -o RESULT-tables";
  if (t.ok == 0) {
    judged.Beware("no sensor shows the bending of the shaft");
    judged.next =
        "add a sensor of the bending to the recording: the tip as seen, EM, strain or load";
    judged.command.clear();
  }
  if (t.chi2_per_measurement > kDoubtful) {
    judged.Beware(fmt::format(
        "the fit misses the sensors by {:.1f} times their stated noise: the instrument or a sensor "
        "is not as the recording says",
        misfit));
    judged.next = "find the cause";
    judged.command = "flextip diagnose RECORDING -o RESULT-cause";
  }
  const int failed = t.not_converged + t.bad_input;
  if (failed > 0) {
    judged.Mention(fmt::format("{} of {} samples could not be estimated", failed, t.samples),
                   failed > kFewFailed * t.samples);
  }
  if (t.ok > 0 && t.force_along_sd_N > kManyTimesAlong * t.force_across_sd_N) {
    judged.Mention(
        fmt::format("the tip's force is known to {:.2g} N across the shaft, and to {:.2g} N along "
                    "it: a force along the shaft hardly bends it",
                    t.force_across_sd_N, t.force_along_sd_N),
        false);
  }
  return judged;
}

}  // namespace flextip
