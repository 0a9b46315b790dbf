// How well the base simulation and an extended model predict a recording that neither was fitted
// to.
#pragma once

#include <string>
#include <vector>

#include "core/judgement.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/model/extended_model.h"

namespace flextip::diagnosis {

struct Prediction {
  /// Errors on the whole recording, as ModelScore has them on parts of one.
  ModelScore base, extended;
  double base_tip_mean_m = 0.0, extended_tip_mean_m = 0.0;
  /// Extended over base: the weighted error of all channels, and the tip's RMS. Nothing where no
  /// sensor is judged.
  Gain gain;
  ResidualTable residuals;
  int samples = 0, judged = 0;         ///< of them: both models have an equilibrium
  std::vector<std::string> not_shown;  ///< effects of the model whose sensor the recording lacks
  std::vector<std::string> warnings;
};

/// Finds again what is the recording's own (FindAgain): how the sensors' frames are registered,
/// forces that were not measured, where a play stood, and phases. Drifts and clocks run at the
/// model's rate from this recording's start. Effects within tolerance act as the model has them,
/// but for what is another recording's own. Throws InputError where the recording cannot be judged
/// (sample_set.h) and WorkError where a model has no equilibrium; `name` is the recording's in
/// messages.
Prediction Predict(const Recording& recording, const std::string& name, const ExtendedModel& model,
                   const EffectMakers& own = {});

/// Commands name MODEL where they need the model's file.
Judgement JudgePrediction(const Prediction& prediction);

}  // namespace flextip::diagnosis
