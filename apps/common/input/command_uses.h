// What each command that reads a recording does with its parts.
#pragma once

#include <string>

#include "plausibility/command_use.h"

namespace flextip {

plausibility::CommandUse UseOfTrack(bool with_model);
plausibility::CommandUse UseOfEstimate();
plausibility::CommandUse UseOfDiagnose();
plausibility::CommandUse UseOfPredict();
plausibility::CommandUse UseOfHandEye(bool collar);
/// `sensor`: "wrist0", "em0" or "tags0".
plausibility::CommandUse UseOfTip(const std::string& sensor);
/// `reference`: "wrist" or "vision".
plausibility::CommandUse UseOfEm(const std::string& reference);
plausibility::CommandUse UseOfStrain();
plausibility::CommandUse UseOfStiffness();
plausibility::CommandUse UseOfBudget();

}  // namespace flextip
