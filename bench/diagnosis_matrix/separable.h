// Whether hidden effects could be told at all from what else the recording might hold.
#pragma once

#include <optional>

#include "bench/diagnosis_matrix/rival.h"
#include "bench/diagnosis_matrix/true_model.h"

namespace flextip::bench {

/// Of the one or two effects that are present. The model is linearised about the label's true
/// parameters of all effects; sensors, motion, load and noise are the recording's. Effects of which
/// one shows nowhere are not apart from the others by themselves. The rival's name is empty where
/// the model has no equilibrium.
Separation MeasureSeparation(TrueModel& truth);

/// The same of what the present effects leave where the catalogue lacks them.
Separation MeasureDeleted(TrueModel& truth);

/// The parameters' normal matrix about the label's true parameters, generic terms at their best.
/// Empty where the model has no equilibrium.
std::optional<Eigen::MatrixXd> InformationAtTruth(TrueModel& truth);

}  // namespace flextip::bench
