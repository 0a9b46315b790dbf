// From linear light to the camera's 8-bit picture: noise, clipping, gamma.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "simulation/render/laparoscope.h"

namespace flextip::simulation::render {

/// The sensor and its electronics. Noise depends on (seed, frame number, pixel) alone.
class Film {
 public:
  Film(const LaparoscopeOptions& options, double gamma);

  Image Develop(const LinearImage& light, int frame_number) const;

 private:
  void DevelopRow(const float* light, std::uint8_t* out, int count, std::uint64_t state) const;

  double electrons_, read_electrons_;
  std::uint64_t seed_;
  std::vector<std::uint8_t> code_;  // of the signal's root in steps of 1/65535
  std::vector<float> normal_;       // quantiles of the standard normal distribution
};

}  // namespace flextip::simulation::render
