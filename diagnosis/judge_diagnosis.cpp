#include "diagnosis/judge_diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace flextip::diagnosis {
namespace {

constexpr double kAbsurd = 100.0;  // times the data sheets' noise

/// A probability in per cent. No recording makes an answer certain.
std::string Percent(double probability) {
  if (probability > 0.99) return "over 99 %";
  return fmt::format("{:.0f} %", 100.0 * probability);
}

/// How many times the noise of the data sheets the extended model misses the sensors by. A misfit
/// that looks like noise is in the noise taken.
double TimesStatedNoise(const DiagnosisResult& result) {
  const double taken = *std::max_element(result.noise_scale.begin(), result.noise_scale.end());
  return std::sqrt(result.extended.chi2_per_dof) * std::max(1.0, taken);
}

std::string AnswerOf(const DiagnosisResult& result) {
  std::string says =
      fmt::format("{} ({})", Joined(result.verdict), Percent(result.probabilities[0].probability));
  for (const auto& group : result.indistinguishable) {
    if (group.size() < 2) continue;
    says += fmt::format("; {} could as well be {}", group[0],
                        fmt::join(group.begin() + 1, group.end(), " or "));
  }
  if (result.gain.measured)
    says += fmt::format("; held-out error {:.2f} of the base's", result.gain.heldout_error_ratio);
  return says + ".";
}

}  // namespace

Judgement JudgeDiagnosis(const DiagnosisResult& result) {
  Judgement judged;
  if (const double times = TimesStatedNoise(result); times > kAbsurd) {
    judged.grade = Grade::kNotFound;
    judged.says = fmt::format(
        "No model of this instrument comes near the recording: the best misses the sensors by "
        "{:.0f} times their noise.",
        times);
    judged.next = "find the stream that does not fit";
    judged.command = "flextip check RECORDING";
    return judged;
  }
  judged.says = AnswerOf(result);
  for (const std::string& warning : result.warnings) judged.Beware(warning);
  if (!result.converged)
    judged.Beware("the search did not come to rest: more data may change the answer");
  if (!result.separating_motion.empty())
    judged.next = "to tell the alternatives apart, record " + result.separating_motion;
  return judged;
}

}  // namespace flextip::diagnosis
