// What the pixels of a collar's tags tell of its pose.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "core/camera.h"
#include "core/pose.h"
#include "core/tag_collar.h"

namespace flextip {

struct PixelSetting {
  CameraCalibration camera;  ///< without lens distortion; gamma 2.2 within 0.4 where absent
  double noise_grey = 2.5;
  double blur_px = 0.8;  ///< Gaussian, before the pixels
};

/// Returns whether a tag at T_CG faces the camera by less than 84 degrees, as the tracker asks.
bool FacesCamera(const Pose& T_CG);

/// Returns the Cramer-Rao bound of (dw, dp), where the true pose is (exp([dw]x) R, p + dp) of T_CE
/// (rad, m; in C), from the pixels of all tags that face the camera. Unknown beside the pose: black
/// and white of each tag with their slopes, the blur's three variances, and gamma. Empty where no
/// tag is in the picture.
std::optional<Eigen::Matrix<double, 6, 6>> PoseBoundOfPixels(const TagCollar& collar,
                                                             const PixelSetting& setting,
                                                             const Pose& T_CE);

}  // namespace flextip
