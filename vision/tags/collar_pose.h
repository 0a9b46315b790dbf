// The pose of the tip frame E in the camera from every visible tag of the collar at once.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "core/pose.h"
#include "core/tag_collar.h"
#include "vision/camera_model.h"
#include "vision/tags/detector.h"

namespace flextip {

enum class CollarPoseStatus {
  kOk,
  kNoTags,        ///< no detection belongs to the collar
  kNotConverged,  ///< no start led to a minimum
  kPoorFit,       ///< the corners do not fit the collar: rms above the limit
};

struct CollarPoseOptions {
  double corner_noise_floor_px = 0.05;  ///< standard deviation per axis that is never undercut
  /// Corner variance known from earlier frames, and its degrees of freedom. Both are pooled with
  /// those of this frame.
  double prior_variance_px2 = 0.01;
  double prior_dof = 4.0;
  double max_rms_px = 2.0;
  int max_iterations = 50;
};

struct CollarPose {
  CollarPoseStatus status = CollarPoseStatus::kNoTags;
  Pose T_CE;
  /// Covariance of (dw, dp), where the true pose is (exp([dw]x) R, p + dp) of T_CE; both in C (rad,
  /// m).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double rms_px = 0.0;  ///< per corner: sqrt(mean squared distance)
  double squared_error_px2 = 0.0;
  int dof = 0;                   ///< residuals less 6
  double corner_noise_px = 0.0;  ///< the standard deviation per axis behind `covariance`
  int tags_used = 0;
  bool ambiguous = false;           ///< `alternative` explains the corners nearly as well
  std::optional<Pose> alternative;  ///< T_CE of the next best minimum, where there is one

  bool IsUsable() const { return status == CollarPoseStatus::kOk; }
};

/// Estimates the pose of the tip frame E in C by least squares on the reprojection error of all
/// corners. Starts from both planar poses of each tag. `near_T_CE`, if given, is one more start,
/// and decides between ambiguous minima. Failures are a status in the result.
CollarPose EstimateCollarPose(const CameraModel& camera, const TagCollar& collar,
                              const std::vector<TagDetection>& tags,
                              const CollarPoseOptions& options = {},
                              const std::optional<Pose>& near_T_CE = {});

/// Returns the four corners of a tag in E (m), in the order of TagDetection.
std::array<Eigen::Vector3d, 4> CornersInE(const CollarTag& tag);

}  // namespace flextip
