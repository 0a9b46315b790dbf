// Views and wrists of a hand-eye calibration for the comparison: real ones and hard made-up ones.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/hand_eye/hand_eye.h"

namespace flextip::bench {

/// The tracked laparoscope of scikit-surgerycalibration (text files in mm): R is the marker on the
/// scope, W the one on the board, so the camera stands still in R. `inset`: a second board in the
/// middle of the first one, a quarter turned, whose corners count as the first one's.
HandEyeInput ReadTrackedScope(const std::filesystem::path& folder, const BoardSpec& board,
                              const std::optional<BoardSpec>& inset, double orientation_noise_rad,
                              double position_noise_m);

/// The lens of `input.camera` fitted to the same pictures (five coefficients, board held flat).
void FitScopeCamera(const BoardSpec& board, HandEyeInput& input);

/// The same as a recording with cam0 (pictures copied) and wrist0.
void WriteTrackedScope(const std::filesystem::path& folder, const std::filesystem::path& recording,
                       double orientation_noise_rad, double position_noise_m);

/// A small board far away, so that both planar poses fit nearly alike; `tilt_rad` is by how much it
/// turns.
struct FarBoards {
  HandEyeInput input;
  Pose T_FC, T_KB;  ///< the truth
};
FarBoards MakeFarBoards(int views, double distance_m, double tilt_rad, double corner_noise_px,
                        unsigned seed);

}  // namespace flextip::bench
