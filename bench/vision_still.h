// Single pictures of a hexagonal collar, one property of which is swept.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/vision_figures.h"

namespace flextip {

/// The base case; a sweep changes one of them.
struct StillCase {
  int width_px = 1280;
  double tag_px = 45, blur_px = 0.8, noise_grey = 2.5, angle_deg = 25, gamma = 2.2;
};

struct Still {
  Image grey;
  PictureTruth truth;
};

/// Renders stills of one case: the collar 0.11 m away near the middle of the picture, one tag to
/// the front but for a turn about the shaft of 20 degrees at most, the shaft's lean out of the
/// picture being `angle_deg` to either side. Blur is in linear light; noise is Gaussian, added to
/// the 8-bit values.
class StillMaker {
 public:
  explicit StillMaker(const StillCase& one, std::uint64_t seed);
  ~StillMaker();
  StillMaker(const StillMaker&) = delete;
  StillMaker& operator=(const StillMaker&) = delete;

  const CameraCalibration& Camera() const;
  const TagCollar& Collar() const;
  Still Make(int number) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
