// Rectification as OpenCV and ROS read it.
#pragma once

#include <string>

#include "calibration/stereo/rectification.h"

namespace flextip {

/// A FileStorage with K1, D1, K2, D2, R, T (x_C1 = R x_C0 + T, m), R1, R2, P1, P2, Q.
std::string OpenCvStereoText(const std::array<CameraCalibration, 2>& cameras, const Pose& T_C0C1,
                             const Rectification& rectification);

/// A camera_info file of one eye, with its rectification and projection matrices. Empty where ROS
/// has no such lens model.
std::string RosCameraInfoText(const std::string& name, int eye, const CameraCalibration& camera,
                              const Rectification& rectification);

}  // namespace flextip
