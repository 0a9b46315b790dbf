#include "vision/photometric/lens_map.h"

#include <array>
#include <limits>

namespace flextip {
namespace {

constexpr int kNodeStep_px = 6;

// Interpolates by a cubic through four nodes at -1, 0, 1, 2 (Lagrange).
std::array<double, 4> Weights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

// Makes the rays at nodes from one step left of and above the image to two steps beyond it.
struct Nodes {
  int across, down;
  std::vector<Eigen::Vector2d> rays;
  const Eigen::Vector2d& At(int i, int j) const {
    return rays[static_cast<std::size_t>(j + 1) * across + i + 1];
  }
};

Nodes ComputeNodes(const CameraModel& camera) {
  const CameraCalibration& c = camera.Calibration();
  Nodes nodes{c.width_px / kNodeStep_px + 4, c.height_px / kNodeStep_px + 4, {}};
  nodes.rays.reserve(static_cast<std::size_t>(nodes.across) * nodes.down);
  for (int j = -1; j < nodes.down - 1; ++j) {
    for (int i = -1; i < nodes.across - 1; ++i) {
      const auto ray = camera.Unproject(Eigen::Vector2d(i, j) * kNodeStep_px);
      const bool seen = ray && ray->z() > 0.05;
      nodes.rays.push_back(
          seen ? Eigen::Vector2d(ray->head<2>() / ray->z())
               : Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
    }
  }
  return nodes;
}

}  // namespace

LensMap::LensMap(const CameraModel& camera)
    : width_px_(camera.Calibration().width_px), height_px_(camera.Calibration().height_px) {
  const Nodes nodes = ComputeNodes(camera);
  std::array<std::array<double, 4>, kNodeStep_px> weights;
  for (int k = 0; k < kNodeStep_px; ++k)
    weights[k] = Weights(static_cast<double>(k) / kNodeStep_px);
  rays_.resize(static_cast<std::size_t>(width_px_) * height_px_);
  std::vector<Eigen::Vector2d> row(nodes.across);  // nodes interpolated to one row of pixels
  for (int y = 0; y < height_px_; ++y) {
    const int j = y / kNodeStep_px;
    const auto& wy = weights[y % kNodeStep_px];
    for (int i = -1; i < nodes.across - 1; ++i) {
      row[i + 1] = wy[0] * nodes.At(i, j - 1) + wy[1] * nodes.At(i, j) +
                   wy[2] * nodes.At(i, j + 1) + wy[3] * nodes.At(i, j + 2);
    }
    for (int x = 0; x < width_px_; ++x) {
      const Eigen::Vector2d* at = &row[x / kNodeStep_px];
      const auto& wx = weights[x % kNodeStep_px];
      const Eigen::Vector2d ray = wx[0] * at[0] + wx[1] * at[1] + wx[2] * at[2] + wx[3] * at[3];
      rays_[static_cast<std::size_t>(y) * width_px_ + x] = {static_cast<float>(ray.x()),
                                                            static_cast<float>(ray.y())};
    }
  }
}

}  // namespace flextip
