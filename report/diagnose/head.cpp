#include "report/diagnose/head.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace flextip::report {
namespace {

std::string Arrow(double before, double after) { return Brief(before) + " → " + Brief(after); }

}  // namespace

void AddGainFigures(Report& report, const DiagnosedResult& result) {
  std::vector<std::pair<std::string, std::string>> figures;
  figures.emplace_back(result.adequate ? "probability" : "probability among the known causes",
                       PercentOf(result, result.VerdictProbability()));
  if (result.heldout_error_ratio && !result.Is("none")) {
    figures.emplace_back("held-out error",
                         "× " + fmt::format("{:.2f}", *result.heldout_error_ratio));
  }
  const auto &base = result.base, &extended = result.extended;
  if (base.tip_prediction_rms_m && extended.tip_prediction_rms_m) {
    figures.emplace_back("tip prediction, rms (mm)", Arrow(1e3 * *base.tip_prediction_rms_m,
                                                           1e3 * *extended.tip_prediction_rms_m));
  }
  if (base.chi2_per_dof && extended.chi2_per_dof) {
    figures.emplace_back("chi-squared per degree of freedom",
                         Arrow(*base.chi2_per_dof, *extended.chi2_per_dof));
  }
  if (const auto& loop = result.closed_loop; loop && loop->max_before_m && loop->max_after_m) {
    figures.emplace_back("closed loop, largest deviation (mm)",
                         Arrow(1e3 * *loop->max_before_m, 1e3 * *loop->max_after_m));
  }
  report.AddNumbers(figures);
}

void AddWarningsNotSaid(Report& report, const DiagnosedResult& result, const RunSummary& summary,
                        const std::vector<std::string>& said) {
  std::vector<std::string> warnings;
  for (const auto* list : {&result.warnings, &summary.warnings}) {
    for (const auto& w : *list) {
      const auto is = [&](const std::vector<std::string>& texts) {
        return std::find(texts.begin(), texts.end(), w) != texts.end();
      };
      if (!is(said) && !is(warnings)) warnings.push_back(w);
    }
  }
  report.AddWarnings(warnings);
}

Head HeadOfDiagnosis(const std::filesystem::path& folder, const DiagnosedResult& result,
                     const Headline& headline) {
  Head head = VerdictOf(folder);
  if (head.grade == kNoAnswer) return head;
  head.says = headline.verdict;
  head.causes = headline.causes;
  head.more = headline.gain;
  const bool said = !result.separating_motion.empty() &&
                    head.next.find(result.separating_motion) != std::string::npos;
  if (!said) head.advice = headline.advice;
  if (!headline.runner_up.empty()) {
    head.advice += (head.advice.empty() ? "" : " ") + headline.runner_up;
  }
  return head;
}

}  // namespace flextip::report
