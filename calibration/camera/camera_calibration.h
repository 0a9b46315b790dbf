// A camera's intrinsics from views of a board.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "calibration/boards/board.h"
#include "calibration/camera/choice.h"
#include "calibration/camera/outliers.h"
#include "calibration/camera/solution.h"

namespace flextip {

struct CameraCalibrationOptions {
  std::optional<LensModel> lens;  ///< empty: all are tried, and held-out views choose
  /// Whether the board may be bent; empty: held-out views decide.
  std::optional<bool> warp;
  /// How well each coordinate of a corner's place on the board is known; above 0 the places are
  /// estimated too. Empty: held-out views decide whether they are, and the views how well.
  std::optional<double> board_sd_m;
  int folds = 6;
  OutlierRule outliers;
};

struct CalibrationView {
  std::string name;
  bool used = false;
  std::string reason;  ///< why it was rejected
};

enum class CameraCalibrationStatus { kOk, kTooFewViews, kNotDetermined };

struct CameraCalibrationResult {
  CameraCalibrationStatus status = CameraCalibrationStatus::kTooFewViews;
  std::string message;
  CameraSolution solution;
  Eigen::MatrixXd covariance;             ///< solution.Covariance()
  double heldout_rms_px = 0.0;            ///< of the views used, each left out once
  std::vector<LensCandidate> candidates;  ///< where the lens was chosen
  std::string warp_reason;                ///< why the board was, or was not, taken for flat
  std::string shape_reason;               ///< why its corners were, or were not, as described
  std::vector<CalibrationView> views;     ///< all that were given
  int views_used = 0, views_rejected = 0;

  bool IsUsable() const { return status == CameraCalibrationStatus::kOk; }
  /// Returns standard deviations of fu, fv, cu, cv (px), then of the distortion coefficients.
  std::vector<double> StandardDeviations() const;
};

/// Throws InputError for a size that is not positive and a lens model that there is not. A camera
/// that the views do not determine (all facing the board straight on, say) is a status.
CameraCalibrationResult CalibrateCamera(const std::vector<BoardView>& views, int width_px,
                                        int height_px, const BoardSpec& board,
                                        const CameraCalibrationOptions& options = {});

}  // namespace flextip
