// A camera's intrinsics from pictures of a flat board.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/board.h"
#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"

namespace flextip {

/// One picture with the name it goes by in messages.
struct CalibrationImage {
  std::string name;
  Image image;
};

struct CameraCalibrationOptions {
  Distortion distortion = Distortion::kOpenCv;  ///< with its `distortion_terms`
  int distortion_terms = 5;
  int min_views = 3;
  /// A view whose error is above this many times the median of all is rejected.
  double outlier_ratio = 4.0;
};

struct CalibrationView {
  std::string name;
  bool used = false;
  std::string reason;                       ///< why it was rejected
  double rms_px = 0.0;                      ///< of the views used
  Pose T_CB;                                ///< board to camera, of the views used
  std::vector<Eigen::Vector2d> corners_px;  ///< row by row, empty where no board was found
};

enum class CameraCalibrationStatus { kOk, kTooFewViews, kNotConverged };

struct CameraCalibrationResult {
  CameraCalibrationStatus status = CameraCalibrationStatus::kTooFewViews;
  std::string message;
  CameraCalibration camera;
  /// Standard deviations: fu, fv, cu, cv (px), then the distortion coefficients.
  std::vector<double> standard_deviations;
  double rms_reprojection_error_px = 0.0;  ///< per corner distance
  int views_used = 0, views_rejected = 0;
  std::vector<CalibrationView> views;

  bool IsUsable() const { return status == CameraCalibrationStatus::kOk; }
};

/// Calibrates from pictures of one size. Throws InputError for a board that is not supported yet,
/// no pictures, an empty picture or one of another size than the first.
CameraCalibrationResult CalibrateCamera(const std::vector<CalibrationImage>& images,
                                        const BoardSpec& board,
                                        const CameraCalibrationOptions& options = {});

}  // namespace flextip
