// A camera's calibration as data. The mathematics is in vision/camera_model.h.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "core/pose.h"

namespace flextip {

enum class Distortion {
  kRadialTangential,  ///< k1 k2 p1 p2
  kOpenCv,            ///< k1 k2 p1 p2 k3 [k4 k5 k6 [s1 s2 s3 s4]]: 5, 8 or 12 terms
  kEquidistant,       ///< k1 k2 k3 k4 of Kannala and Brandt's fisheye
};

/// Pinhole with lens distortion. Pixel (0,0) is the centre of the top-left pixel.
struct CameraCalibration {
  int width_px = 0, height_px = 0;
  double fu_px = 0, fv_px = 0, cu_px = 0, cv_px = 0;
  Distortion distortion = Distortion::kRadialTangential;
  std::vector<double> distortion_coefficients = {0, 0, 0, 0};
  std::optional<double> gamma;  ///< exponent with which the camera encodes linear light
  Pose T_RC;                    ///< x right, y down, z forward
  double rate_hz = 30.0;
};

}  // namespace flextip
