// Lenses, and the normal distribution, for tests of cameras and of blurred edges.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "core/camera.h"

namespace flextip {

inline CameraCalibration WithLens(CameraCalibration camera, Distortion distortion,
                                  std::vector<double> coefficients) {
  camera.distortion = distortion;
  camera.distortion_coefficients = std::move(coefficients);
  return camera;
}

/// `plain` with each lens model, each number of coefficients.
inline std::vector<CameraCalibration> WithEachLens(const CameraCalibration& plain) {
  return {
      WithLens(plain, Distortion::kRadialTangential, {0, 0, 0, 0}),
      WithLens(plain, Distortion::kRadialTangential, {-0.22, 0.08, 0.0006, -0.0004}),
      WithLens(plain, Distortion::kOpenCv, {-0.28, 0.07, 0.0012, -0.0002, 0.02}),
      WithLens(plain, Distortion::kOpenCv, {0.5, -0.2, 0.001, 0.0007, 0.05, 0.8, -0.1, 0.03}),
      WithLens(
          plain, Distortion::kOpenCv,
          {-0.2, 0.06, 0.0003, -0.001, 0.01, 0.05, 0.02, 0.004, 0.002, -0.001, 0.0015, 0.0007}),
      WithLens(plain, Distortion::kEquidistant, {-0.02, 0.005, -0.003, 0.0004}),
  };
}

inline double NormalCdf(double x) { return 0.5 * std::erfc(-x * M_SQRT1_2); }

}  // namespace flextip
