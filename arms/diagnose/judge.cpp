#include "arms/diagnose/judge.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace flextip::arms {
namespace {

constexpr double kWorthIt = 0.98;        // of the base's error
constexpr double kFarBeyond = 2.0;       // standard deviations of noise
constexpr std::size_t kMostReasons = 4;  // of numbers that cannot be told

std::string HowLikely(double probability) {
  return probability > 0.99 ? std::string("over 99 %") : fmt::format("{:.0f} %", 100 * probability);
}

std::string ChangeText(const ArmResult& result, const Change& change) {
  std::string text = fmt::format("{} in {} ({}", change.effect, result.recordings[change.first_in],
                                 HowLikely(change.probability));
  for (const auto& p : change.parameters) {
    if (p.name == "mass_kg") text += fmt::format(", {:.3f} kg", p.value[0]);
    if (p.name == "place") text += fmt::format(" at place {:.0f}", p.value[0]);
  }
  return text + ")";
}

}  // namespace

Judgement JudgeArm(const ArmResult& result) {
  const auto& answer = result.answer;
  Judgement judged;
  judged.says = fmt::format("{} ({})", diagnosis::Joined(answer.verdict),
                            HowLikely(answer.probabilities.front().probability));
  for (const auto& group : answer.indistinguishable) {
    if (group.size() < 2) continue;
    judged.says += fmt::format("; {} could as well be {}", group[0],
                               fmt::join(group.begin() + 1, group.end(), " or "));
  }
  for (const Change& change : result.changes) judged.says += "; " + ChangeText(result, change);
  if (answer.gain.measured)
    judged.says +=
        fmt::format("; held-out error {:.2f} of the base's", answer.gain.heldout_error_ratio);
  judged.says += ".";
  for (const std::string& warning : answer.warnings) judged.Beware(warning);
  if (!answer.converged)
    judged.Beware("the search did not come to rest: more data may change the answer");
  if (answer.extended.weighted_rms > kFarBeyond) {
    judged.Beware(
        fmt::format("what is left is {:.1f} times the stated noise: the known causes do "
                    "not explain all of it",
                    answer.extended.weighted_rms));
  }
  for (std::size_t i = 0; i < result.not_told.size() && i < kMostReasons; ++i)
    judged.Mention(result.not_told[i], false);
  const bool gain = answer.gain.measured && answer.gain.heldout_error_ratio < kWorthIt;
  if (gain) {
    judged.next = "see what the model is worth on another motion";
    judged.command = "flextip predict OTHER_RECORDING --model RESULT/model.yaml -o RESULT-predict";
  } else {
    judged.next = "keep the arm's file as it is";
  }
  return judged;
}

Judgement JudgeArmPrediction(const ArmPrediction& prediction) {
  Judgement judged;
  judged.says =
      fmt::format("The extended model leaves {:.2f} of the base's error", prediction.ratio);
  if (prediction.base_tip_rms_m > 0.0) {
    judged.says +=
        fmt::format("; tip {:.2f} mm in place of {:.2f} mm", 1e3 * prediction.extended_tip_rms_m,
                    1e3 * prediction.base_tip_rms_m);
  }
  judged.says += ".";
  if (prediction.ratio > kWorthIt) judged.Beware("the model gains nothing on this recording");
  for (const std::string& effect : prediction.not_shown)
    judged.Mention(fmt::format("this recording cannot show {}", effect), false);
  judged.next = prediction.ratio > kWorthIt ? "diagnose this recording too"
                                            : "use the model where the arm's joints are used";
  return judged;
}

}  // namespace flextip::arms
