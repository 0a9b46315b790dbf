#include "simulation/render/veil.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace flextip::simulation::render {
namespace {

constexpr int kGrid_px = 4;  // the density is computed at every fourth pixel

double Random(int x, int y, std::uint64_t seed) {
  std::uint64_t h = seed * 0x9e3779b97f4a7c15ull + static_cast<std::uint32_t>(x) * 0x8da6b343ull +
                    static_cast<std::uint32_t>(y) * 0xd8163841ull;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((h ^ (h >> 31)) >> 11) * 0x1p-53;
}

double ValueNoise(double x, double y, std::uint64_t seed) {
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
  const double u = smooth(x - x0), v = smooth(y - y0);
  const double top = std::lerp(Random(x0, y0, seed), Random(x0 + 1, y0, seed), u);
  const double low = std::lerp(Random(x0, y0 + 1, seed), Random(x0 + 1, y0 + 1, seed), u);
  return std::lerp(top, low, v);
}

// 0 to 1.
double Clouds(double x, double y, std::uint64_t seed) {
  return (4 * ValueNoise(x, y, seed) + 2 * ValueNoise(2 * x, 2 * y, seed + 1) +
          ValueNoise(4 * x, 4 * y, seed + 2)) /
         7;
}

cv::Mat1f TransmissionOf(const Smoke& smoke, int frame, std::uint64_t seed, int parts_per_px,
                         cv::Size size) {
  const int grid = kGrid_px * parts_per_px;
  cv::Mat1f coarse((size.height + grid - 1) / grid, (size.width + grid - 1) / grid);
  const double drift_px = smoke.drift_px * (frame - smoke.frames.first);
  for (int j = 0; j < coarse.rows; ++j) {
    for (int i = 0; i < coarse.cols; ++i) {
      const double x = (i * kGrid_px - drift_px) / smoke.scale_px,
                   y = j * kGrid_px / smoke.scale_px;
      const double density = 1 + smoke.unevenness * (2 * Clouds(x, y, seed) - 1);
      coarse(j, i) = static_cast<float>(std::pow(smoke.transmission, density));
    }
  }
  cv::Mat1f fine;
  cv::resize(coarse, fine, size, 0, 0, cv::INTER_LINEAR);
  return fine;
}

}  // namespace

void DrawSmoke(const std::vector<Smoke>& smoke, int frame, std::uint64_t seed, int parts_per_px,
               LinearImage& image) {
  for (std::size_t k = 0; k < smoke.size(); ++k) {
    if (!smoke[k].frames.Has(frame)) continue;
    const cv::Mat1f t = TransmissionOf(smoke[k], frame, seed + 7 * k, parts_per_px,
                                       {image.width_px, image.height_px});
    const Eigen::Vector3f light = smoke[k].light_bgr.cast<float>();
    for (int y = 0; y < image.height_px; ++y) {
      for (int x = 0; x < image.width_px; ++x) {
        Eigen::Map<Eigen::Vector3f> pixel(image.At(x, y));
        pixel = light + t(y, x) * (pixel - light);
      }
    }
  }
}

}  // namespace flextip::simulation::render
