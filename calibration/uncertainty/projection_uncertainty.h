// How well a calibrated camera knows where a point of the world is seen.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <vector>

#include "calibration/camera/solution.h"
#include "calibration/stereo/solution.h"

namespace flextip {

/// Calibrate again from corners with other noise: lens, camera and boards come out a little
/// different, together. A point that stands still in the world, that is relative to the boards, is
/// then expected at another pixel. The distance to that pixel counts for measuring, not the
/// uncertainty of each parameter alone (a longer focal length with the boards further away sees the
/// same). As the boards do not move alike, the mean over them is the world, as in mrcal
/// ("mean-pcam", https://mrcal.secretsauce.net/uncertainty.html). Of that mean only a small turn
/// and shift (w, t) are needed: a point x_C of the world is at x_C + w x x_C + t in the new camera.
class ProjectionUncertainty {
 public:
  /// Returns the uncertainty of a calibrated camera. Empty where the views do not determine the
  /// solution.
  static std::optional<ProjectionUncertainty> Of(const CameraSolution& solution);
  /// Returns the uncertainty of camera `eye` of two calibrated together.
  static std::optional<ProjectionUncertainty> Of(const StereoSolution& solution, int eye);

  /// Returns the covariance of a pixel (px^2): of the point seen at `px` in the plane z =
  /// `depth_m`, or at infinity (HUGE_VAL). Empty where the lens model sees nothing there.
  std::optional<Eigen::Matrix2d> CovariancePx(const Eigen::Vector2d& px, double depth_m) const;

  /// Returns the same for the point `x_C` of the world (m), or for its direction (`infinite`).
  Eigen::Matrix2d CovarianceOfPoint(const Eigen::Vector3d& x_C, bool infinite) const;

  /// Returns the uncertainty after one more view: the board at T_CB with its corners `x_B` (m),
  /// each seen with the noise of the others.
  ProjectionUncertainty WithView(const Pose& T_CB, const std::vector<Eigen::Vector3d>& x_B) const;

  const CameraCalibration& Camera() const { return camera_; }
  /// Returns the covariance of the intrinsics, the warp where it was estimated, w (rad) and t (m).
  const Eigen::MatrixXd& Covariance() const { return covariance_; }

 private:
  CameraCalibration camera_;
  BoardWarp warp_;
  double noise_px_ = 0.0;
  int intrinsics_ = 0, warps_ = 0, views_ = 0;
  Eigen::MatrixXd covariance_;
};

/// Returns the standard deviation in the direction where it is largest.
double WorstSd(const Eigen::Matrix2d& covariance);

/// The uncertainty over the picture: the worst direction's standard deviation.
struct UncertaintyMap {
  double depth_m = HUGE_VAL;
  std::vector<double> x_px, y_px;  ///< of the grid's columns and rows
  Eigen::MatrixXd sd_px;           ///< rows x columns; NaN where the lens model sees nothing
  Eigen::MatrixXd sd_mm;           ///< across, in the plane z = depth_m; empty at infinity
  double MeanPx() const;           ///< over the places seen
  double LargestPx() const;
  double CentrePx() const;
  double MeanMm() const;
};

/// Maps the uncertainty over `columns` x `rows` places from edge to edge of the picture.
UncertaintyMap MapUncertainty(const ProjectionUncertainty& uncertainty, double depth_m,
                              int columns = 25, int rows = 19);

/// Returns the median distance of the boards' centres along the axis (m): the calibrated distance.
double MedianBoardDepth(const CameraSolution& solution);
/// Returns the same for camera `eye`.
double MedianBoardDepth(const StereoSolution& solution, int eye);

}  // namespace flextip
