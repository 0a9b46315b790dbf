// The shaft's outline fitted to the picture: a term for a joint adjustment, and a fit of its own.
#pragma once

#include <Eigen/Dense>

#include "core/image.h"
#include "core/pose.h"
#include "vision/camera_model.h"
#include "vision/outline/contour_lines.h"
#include "vision/outline/tube_geometry.h"

namespace flextip {

struct ContourOptions {
  int lines_per_side = 24, lines_at_end = 12;
  int search_px = 20;          ///< how far the fit looks at first
  int fine_search_px = 4;      ///< ... and at last
  double blur_px = 0.7;        ///< of the picture, Gaussian
  double unknown_gamma = 2.2;  ///< taken where the camera has none
  /// Prior of the bend (1/m^2, see TubeCentre). A known load makes it narrow.
  Eigen::Vector2d bend_mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d bend_covariance = Eigen::Vector2d(400, 400).asDiagonal();
  ContourErrors errors;
  int least_points = 12;
  double least_part = 0.5;  ///< of the lines in view that must agree with the outline
  double least_end = 0.65;  ///< ... and of the end's lines
  double most_rms_px = 1.0;
};

enum class ContourStatus {
  kOk,
  kTooFewPoints,  ///< too little of the outline seen to fix five of the six: everything but roll
  kNotConverged,
  kAmbiguous,  ///< edges that fit elsewhere nearly as well, or too few that fit here
};

struct ContourFit {
  ContourStatus status = ContourStatus::kTooFewPoints;
  Pose T_CE;
  /// Covariance of (dw, dp) as in MovePose (rad, m). The roll about the tube's axis comes from the
  /// prior alone.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector2d bend = Eigen::Vector2d::Zero();
  ContourTerm term;  ///< at the last pose
  int iterations = 0;

  bool IsUsable() const { return status == ContourStatus::kOk; }
};

/// One tube before one camera. Edges are looked for along scan lines across the predicted outline;
/// neither the tube's brightness nor its background is known.
class ShaftContour {
 public:
  /// Makes the contour of `tube` before `camera`. Throws InputError for a diameter, a length or
  /// standard deviations that are not positive.
  ShaftContour(const CameraModel& camera, const TubeShape& tube,
               const ContourOptions& options = {});

  /// Returns the Gauss-Newton term at T_CE and `bend`, from edges within `search_px` to either
  /// side. Zero where no edge is found. Throws InputError where the picture is empty or not grey.
  ContourTerm Linearise(const Image& grey, const Pose& T_CE, const Eigen::Vector2d& bend,
                        int search_px) const;

  /// Fits the pose from the outline alone, near `predicted` with the covariance of (dw, dp). Throws
  /// InputError as Linearise. Failures are a status in the result.
  ContourFit Fit(const Image& grey, const Pose& predicted,
                 const Eigen::Matrix<double, 6, 6>& covariance) const;

 private:
  std::vector<ContourPoint> Outline(const Pose& T_CE, const Eigen::Vector2d& bend) const;
  bool FindRoughly(const Image& grey, const Eigen::Matrix<double, 6, 6>& information,
                   Pose& T_CE) const;
  ContourStatus Judge(const ContourTerm& term) const;

  CameraModel camera_;
  TubeShape tube_;
  ContourOptions options_;
  ScanEdgeFinder finder_;
};

}  // namespace flextip
