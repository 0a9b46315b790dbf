// Two cameras fixed to each other from pictures of a board that both, or one of them, saw.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/camera_calibration.h"
#include "calibration/stereo_solution.h"

namespace flextip {

/// What was seen at one moment; an eye may have seen no board, or not been there.
struct StereoPair {
  std::array<BoardView, 2> eyes;
};

struct StereoOptions {
  CameraCalibrationOptions camera;  ///< of each eye alone
  /// A pair whose eyes disagree on the board's pose by more than this many times the median pair
  /// (and by more than what its corners' noise may do) is taken apart.
  double pair_ratio = 6.0;
  int folds = 6;  ///< of the pairs, for the held-out errors
};

struct StereoPairResult {
  std::string name;  ///< of both pictures
  std::array<std::string, 2> reason;  ///< why an eye's picture is not used
  std::string pair_reason;  ///< why its two pictures are not taken for one moment
};

enum class StereoStatus { kOk, kEyeFailed, kTooFewPairs, kNotDetermined };

struct StereoResult {
  StereoStatus status = StereoStatus::kTooFewPairs;
  std::string message;
  StereoSolution solution;
  std::array<CameraCalibrationResult, 2> alone;  ///< each eye by itself
  Eigen::MatrixXd covariance;                    ///< solution.Covariance()
  Baseline baseline;
  /// Of pairs left out (lenses and T_C0C1 from the others, the board's pose from its own corners).
  double heldout_rms_px = 0.0;
  std::vector<StereoPairResult> pairs;  ///< all that were given
  int pairs_used = 0, single_views_used = 0;

  bool IsUsable() const { return status == StereoStatus::kOk; }
  Eigen::MatrixXd PairCovariance() const {
    return covariance.block(solution.PairStart(), solution.PairStart(), 6, 6);
  }
};

/// Throws InputError for sizes that are not positive.
StereoResult CalibrateStereo(const std::vector<StereoPair>& pairs,
                             const std::array<Eigen::Vector2i, 2>& size_px, const BoardSpec& board,
                             const StereoOptions& options = {});

}  // namespace flextip
