// Single pictures of a hexagonal collar, one property of which is swept.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/vision/figures.h"
#include "simulation/render/laparoscope.h"

namespace flextip::bench {

/// The base case; a sweep changes one of them.
struct StillCase {
  int width_px = 1280;
  double tag_px = 45, blur_px = 0.8, noise_grey = 2.5, angle_deg = 25;
};

/// What falls on the film, behind the lens.
struct Still {
  simulation::LinearImage light;
  PictureTruth truth;
};

/// Renders stills of one case after another: the collar 0.11 m away near the middle of the picture,
/// one tag to the front but for a turn about the shaft of 20 degrees at most, the shaft's lean out
/// of the picture being `angle_deg` to either side. The lens blurs on a grid of a third of a pixel,
/// in linear light.
class StillMaker {
 public:
  explicit StillMaker(std::uint64_t seed);
  ~StillMaker();
  StillMaker(const StillMaker&) = delete;
  StillMaker& operator=(const StillMaker&) = delete;

  /// To be called first. The tissue is drawn anew only where width, blur or tag size change, which
  /// takes seconds.
  void Show(const StillCase& one);
  const TagCollar& Collar() const;
  CameraCalibration Camera(double gamma) const;
  Still Make(int number) const;
  /// Gamma, Gaussian noise in grey levels, 8 bit.
  Image Film(const simulation::LinearImage& light, double gamma, int number) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip::bench
