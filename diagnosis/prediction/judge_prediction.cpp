#include <fmt/format.h>

#include "diagnosis/prediction/predict.h"

namespace flextip::diagnosis {
namespace {

// A ratio above which a model hardly gains: chance may give any model a few per cent.
constexpr double kGain = 0.9;
constexpr double kWorse = 1.1;  // the same, of a model that does not fit

}  // namespace

Judgement JudgePrediction(const Prediction& prediction) {
  Judgement judged;
  const Gain& gain = prediction.gain;
  if (!gain.measured) {
    judged.grade = Grade::kNotFound;
    judged.says = "No sensor of this recording can be predicted.";
    judged.next = "look at what the recording holds";
    judged.command = "flextip check RECORDING -o RESULT-check";
    return judged;
  }
  const bool gains = gain.heldout_error_ratio < kGain;
  const char* verdict = gains ? "The model holds for this recording:"
                        : gain.heldout_error_ratio > kWorse
                            ? "The model makes the simulation of this recording worse:"
                            : "The model hardly gains on this recording:";
  judged.says = fmt::format(
      "{} the error is {:.2f} of the base simulation's (90 %: {:.2f} to {:.2f}), the predicted "
      "tip's {:.2f}: {:.2f} mm instead of {:.2f} mm.",
      verdict, gain.heldout_error_ratio, gain.heldout_error_ratio_low,
      gain.heldout_error_ratio_high, gain.tip_error_ratio,
      1e3 * prediction.extended.tip_prediction_rms_m, 1e3 * prediction.base.tip_prediction_rms_m);
  for (const std::string& warning : prediction.warnings) judged.Beware(warning);
  if (!gains) judged.Beware("the model may be of another instrument, or something has changed");
  judged.next = gains ? "let the estimator use the model" : "find the causes in this recording";
  judged.command = gains ? "flextip estimate RECORDING --model MODEL -o RESULT-estimate"
                         : "flextip diagnose RECORDING -o RESULT-diagnosis";
  return judged;
}

}  // namespace flextip::diagnosis
