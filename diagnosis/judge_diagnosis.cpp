#include "diagnosis/judge_diagnosis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/search/ambiguity.h"

namespace flextip::diagnosis {
namespace {

constexpr double kAbsurd = 100.0;  // times the data sheets' noise

/// The probability of the answer. No recording makes an answer certain.
std::string HowLikely(const DiagnosisResult& result) {
  const double probability = result.probabilities[0].probability;
  if (!result.IsAdequate() && NamesEffects(result.verdict)) {
    return probability > 0.99 ? std::string("the likeliest of the known causes")
                              : fmt::format("{:.0f} % among the known causes", 100.0 * probability);
  }
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
  std::string says = fmt::format("{} ({})", Joined(result.verdict), HowLikely(result));
  for (const auto& group : result.indistinguishable) {
    if (group.size() < 2) continue;
    says += fmt::format("; {} could as well be {}", group[0],
                        fmt::join(group.begin() + 1, group.end(), " or "));
  }
  for (const Discovered& term : result.discovered) says += "; in the residuals: " + term.text;
  if (result.gain.measured)
    says += fmt::format("; held-out error {:.2f} of the base's", result.gain.heldout_error_ratio);
  return says + ".";
}

/// A model that predicts no better than the base simulation is not worth its use.
bool IsGain(const DiagnosisResult& result) {
  return (NamesEffects(result.verdict) || !result.discovered.empty()) &&
         (!result.gain.measured || result.gain.heldout_error_ratio < 0.98);
}

bool HasAlternatives(const DiagnosisResult& result) {
  return std::ranges::any_of(result.indistinguishable,
                             [](const auto& group) { return group.size() > 1; });
}

void SayNext(const DiagnosisResult& result, Judgement& judged) {
  if (result.verdict == Verdict{"unknown"} && result.discovered.empty()) {
    judged.next =
        "look at the residual patterns, which channel depends on which quantity, and check the "
        "recording";
    judged.command = "flextip check RECORDING -o RESULT-check";
    return;
  }
  const bool gain = IsGain(result);
  judged.next = gain ? "let the estimator use the model" : "keep the base simulation";
  judged.command = gain ? "flextip estimate RECORDING --model RESULT/model.yaml -o RESULT-estimate"
                        : "flextip estimate RECORDING -o RESULT-estimate";
  if (result.plan && !result.plan->places_m.empty()) {
    judged.next = fmt::format("run the planned motion, motion.yaml in the result; until then {}",
                              judged.next);
  } else if (!result.separating_motion.empty() && result.separating_motion_score >= kInseparable) {
    judged.next = fmt::format("to tell the alternatives apart, record {}; until then {}",
                              result.separating_motion, judged.next);
  } else if (HasAlternatives(result)) {
    judged.next = fmt::format(
        "no simple motion tells the alternatives apart, a further sensor may; until then {}",
        judged.next);
  }
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
    judged.command = "flextip check RECORDING -o RESULT-check";
    return judged;
  }
  judged.says = AnswerOf(result);
  for (const std::string& warning : result.warnings) judged.Beware(warning);
  if (!result.converged)
    judged.Beware("the search did not come to rest: more data may change the answer");
  SayNext(result, judged);
  return judged;
}

}  // namespace flextip::diagnosis
