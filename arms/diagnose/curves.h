// What the page draws: curves, residuals, and what the residuals go with.
#pragma once

#include <vector>

#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/heldout.h"
#include "arms/replay/replay.h"
#include "arms/search/noise.h"

namespace flextip::arms {

/// Returns the residuals of all channels where the replay is.
Residuals ResidualsOf(const Replay& replay);

/// Adds measured and predicted of each component over time, by the residuals of both models.
void FillCurves(const Replay& replay, const Residuals& base, const Residuals& extended,
                std::vector<ComponentCurve>& curves);

/// Residuals of both models in stated noise, a row a time of each channel of the first recording;
/// no more than some thousand rows.
diagnosis::ResidualTable ResidualTableOf(const Replay& replay, const Residuals& base,
                                         const Residuals& extended, const Noise& noise);

/// Adds which simple functions of time and joints the residuals of the base go with, strongest
/// first.
void FillSignatures(const Replay& base, const Noise& noise, diagnosis::DiagnosisResult& answer);

}  // namespace flextip::arms
