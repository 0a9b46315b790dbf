// From the scene to linear light in each pixel: its mean over the pixel's area.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/render/laparoscope.h"
#include "simulation/render/light.h"
#include "simulation/render/rays.h"
#include "simulation/render/scene.h"

namespace flextip::simulation::render {

/// Draws a scene over a picture of the tissue. Pixels within one surface take one ray (a tag's
/// cells the exact area of black under the pixel); pixels that a silhouette crosses take 233, on a
/// lattice that is shifted at random from pixel to pixel (Fibonacci's lattice; Cranley and
/// Patterson's shift), so that the area of each side is right to about 0.005 and free of bias.
class Raster {
 public:
  Raster(const PixelRays& rays, const Scene& scene, const Light& light);

  /// `image` holds the tissue (3 channels) and gets the scene drawn over it.
  void Draw(LinearImage& image) const;

 private:
  void ClassifyRow(int j, std::vector<std::uint8_t>& objects) const;
  void DrawRow(int y, const std::vector<std::uint8_t>& objects, LinearImage& image) const;
  bool DrawWithin(int x, int y, int object, Scene::Guesses& guesses, float* out) const;
  void DrawAcross(int x, int y, ObjectMask seen, Scene::Guesses& guesses, float* out) const;
  bool LooksWhole(int x, int y, int object, ObjectMask seen, Scene::Guesses& guesses) const;

  const PixelRays& rays_;
  const Scene& scene_;
  const Light& light_;
};

}  // namespace flextip::simulation::render
