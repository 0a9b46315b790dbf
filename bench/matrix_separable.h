// Whether a hidden effect could be told at all from what else the recording might hold.
#pragma once

#include <string>

#include "simulation/hidden_recording.h"

namespace flextip {

struct Separation {
  /// Twice the log likelihood that the true hypothesis has over its nearest rival, in data without
  /// noise of the effect's true size, each with the parameters that suit it best.
  double value = 0.0;
  /// Another effect; none where the effect does not show enough to be told from nothing.
  std::string rival = "none";
};

/// A log likelihood ratio of 9. Rivals have about the same prior odds, so it leaves the wrong one
/// odds of e^-9, about 1e-4: even noise of two standard deviations against the truth (the ratio's
/// own is the root of 2 x 9, 4.2) does not turn the answer.
inline constexpr double kSeparable = 18.0;

/// For `recording`, as read from the folder of `hidden`, which has one effect of the catalogue. The
/// model is linearised about the label's true parameters of all effects; sensors, motion, load and
/// noise are the recording's. Throws InputError where nothing can be judged (sample_set.h).
Separation MeasureSeparation(const Recording& recording, const HiddenRecording& hidden);

}  // namespace flextip
