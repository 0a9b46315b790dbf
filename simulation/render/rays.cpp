#include "simulation/render/rays.h"

#include <tbb/parallel_for.h>

#include "vision/camera_model.h"

namespace flextip::simulation::render {

PixelRays::PixelRays(const CameraCalibration& camera)
    : width_px_(camera.width_px), height_px_(camera.height_px) {
  const CameraModel model(camera);
  corners_.assign(static_cast<std::size_t>(width_px_ + 1) * (height_px_ + 1),
                  Eigen::Vector3f::Zero());
  tbb::parallel_for(0, height_px_ + 1, [&](int j) {
    for (int i = 0; i <= width_px_; ++i) {
      const auto ray = model.Unproject({i - 0.5, j - 0.5});
      if (ray) corners_[Index(i, j)] = ray->cast<float>();
    }
  });
}

bool PixelRays::Valid(int x, int y) const {
  const auto seen = [&](int i, int j) { return corners_[Index(i, j)].z() > 0.0f; };
  return seen(x, y) && seen(x + 1, y) && seen(x, y + 1) && seen(x + 1, y + 1);
}

PixelRays::Pixel PixelRays::At(int x, int y) const {
  const Eigen::Vector3d a = Corner(x, y), b = Corner(x + 1, y), c = Corner(x, y + 1),
                        d = Corner(x + 1, y + 1);
  return {a, b - a, c - a, d - c - b + a};
}

}  // namespace flextip::simulation::render
