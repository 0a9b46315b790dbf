// How well base and extended model predict a recording of an arm that neither was fitted to: where
// tracker and marker are is found again where they are unknown, nothing else.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "arms/diagnose/diagnose.h"

namespace flextip::arms {

struct ArmPrediction {
  std::map<std::string, double> base_rms, extended_rms;  ///< by channel and component, SI
  double base_tip_rms_m = 0.0, extended_tip_rms_m = 0.0;
  double base_tip_mean_m = 0.0, extended_tip_mean_m = 0.0;
  double ratio = 1.0;      ///< weighted RMS, extended over base
  double tip_ratio = 1.0;  ///< 1 where there is no tip
  int samples = 0;
  std::vector<ComponentCurve> curves;
  diagnosis::ResidualTable residuals;
  std::vector<std::string> not_shown;  ///< effects of the model that this recording cannot show
};

/// Throws InputError where the model is of another arm.
ArmPrediction Predict(const ArmData& data, const ArmModel& model);

}  // namespace flextip::arms
