// What the base simulation's residuals depend on: the pattern a person would look for by eye.
#pragma once

#include "diagnosis/diagnose.h"
#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// Every channel against every regressor of generic_basis.h, and against its own past
/// ("previous_sample": whether it is white in time), strongest first.
std::vector<Signature> FindSignatures(const Replay& base);

/// Residuals of both models and the regressors, sample by sample.
ResidualTable MakeResidualTable(const Replay& base, const Replay& extended);

}  // namespace flextip::diagnosis
