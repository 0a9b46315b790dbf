// Two cameras fixed to each other from pictures of a board that both, or one of them, saw.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera/camera_calibration.h"
#include "calibration/stereo/solution.h"

namespace flextip {

/// The sightings of one moment; an eye may have seen no board (its sighting's `reason` says why).
struct StereoPair {
  std::array<BoardView, 2> eyes;
};

struct StereoOptions {
  CameraCalibrationOptions camera;  ///< of each eye alone
  /// Pictures of a pair whose corners are off by more than this many times the median pair's, and
  /// were not when each eye was calibrated alone, are not of one moment.
  double pair_ratio = 4.0;
  int folds = 6;  ///< of the pairs, for the held-out errors
};

struct StereoPairResult {
  std::array<std::string, 2> names;
  std::array<std::string, 2> reasons;  ///< why an eye's picture is not used; empty where it is
  std::string apart;  ///< why its two pictures, though used, are not taken for one moment
};

enum class StereoStatus { kOk, kEyeFailed, kTooFewPairs, kNotDetermined };

/// Errors of pairs that were left out: lenses and T_C0C1 are from the other pairs.
struct StereoHeldOut {
  double rms_px = 0.0;              ///< per corner, the board's pose from the pair's own corners
  double epipolar_rms_px = 0.0;     ///< difference of rows after rectification
  double length_rms_m = 0.0;        ///< of distances between neighbouring corners, triangulated
  double length_mean_m = 0.0;       ///< the mean of that error: a scale that is wrong
  std::vector<double> squared_px2;  ///< of each pair, fold by fold: the mean squared distance
};

struct StereoResult {
  StereoStatus status = StereoStatus::kTooFewPairs;
  std::string message;
  StereoSolution solution;
  std::array<CameraCalibrationResult, 2> alone;  ///< each eye by itself
  Eigen::MatrixXd covariance;                    ///< solution.Covariance()
  Baseline baseline;
  double epipolar_rms_px = 0.0;  ///< of the pairs that were calibrated from
  std::optional<StereoHeldOut> heldout;
  std::string shape_reason;             ///< why the board's corners were, or were not, as described
  std::vector<StereoPairResult> pairs;  ///< all that were given
  int pairs_used = 0, single_views_used = 0;

  bool IsUsable() const { return status == StereoStatus::kOk; }
  /// Returns the covariance of (dw, dp) of T_C0C1 (rad, m).
  Eigen::MatrixXd PairCovariance() const {
    return covariance.block(solution.PairStart(), solution.PairStart(), 6, 6);
  }
};

/// Calibrates each eye alone first, with its outliers and its lens, then both together. Throws
/// InputError for sizes that are not positive.
StereoResult CalibrateStereo(const std::vector<StereoPair>& pairs,
                             const std::array<Eigen::Vector2i, 2>& sizes_px, const BoardSpec& board,
                             const StereoOptions& options = {});

}  // namespace flextip
