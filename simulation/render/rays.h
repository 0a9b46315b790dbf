// The rays of all pixels, computed once: a lens with distortion costs the renderer nothing a frame.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/camera.h"

namespace flextip::simulation::render {

/// Rays from the camera's centre through the corners of the pixels. Corner (i, j) is at pixel
/// (i - 0.5, j - 0.5). Within a pixel rays are interpolated, which is right to 1e-3 px for any lens
/// whose distortion changes slowly over a pixel.
class PixelRays {
 public:
  explicit PixelRays(const CameraCalibration& camera);

  int WidthPx() const { return width_px_; }
  int HeightPx() const { return height_px_; }

  /// The ray (unit) of a corner, i in [0, width], j in [0, height]; zero where the lens sees none.
  Eigen::Vector3d Corner(int i, int j) const { return corners_[Index(i, j)].cast<double>(); }

  /// False where the lens sees nothing at a corner of the pixel: such pixels stay black.
  bool Valid(int x, int y) const;

  /// The rays of one pixel: At(u, v) for u right and v down in [0, 1] (not of unit length).
  struct Pixel {
    Eigen::Vector3d origin, du, dv, duv;
    Eigen::Vector3d At(double u, double v) const { return origin + u * du + v * (dv + u * duv); }
    Eigen::Vector3d Centre() const { return At(0.5, 0.5); }
  };
  Pixel At(int x, int y) const;

 private:
  std::size_t Index(int i, int j) const {
    return static_cast<std::size_t>(j) * (width_px_ + 1) + i;
  }

  int width_px_, height_px_;
  std::vector<Eigen::Vector3f> corners_;
};

}  // namespace flextip::simulation::render
