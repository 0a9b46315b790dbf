// The ray of every pixel of a camera, computed once.
#pragma once

#include <vector>

#include "vision/camera_model.h"

namespace flextip {

/// Rays (x/z, y/z) of all pixels, interpolated from nodes some pixels apart. Right to 1e-4 px where
/// the lens model is one-to-one.
class LensMap {
 public:
  struct Ray {
    float x, y;  ///< NaN where the lens sees nothing
  };

  explicit LensMap(const CameraModel& camera);

  int WidthPx() const { return width_px_; }
  int HeightPx() const { return height_px_; }
  const Ray& At(int x, int y) const { return rays_[static_cast<std::size_t>(y) * width_px_ + x]; }

 private:
  int width_px_, height_px_;
  std::vector<Ray> rays_;
};

}  // namespace flextip
