// Smoke over a finished picture of linear light.
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/render/laparoscope.h"

namespace flextip::simulation::render {

/// The smoke of one frame, drawn over `image` (3 channels; Smoke's lengths count `parts_per_px` of
/// its pixels as one). Clouds are value noise of three octaves
/// that depends on the seed and drifts to the right.
void DrawSmoke(const std::vector<Smoke>& smoke, int frame, std::uint64_t seed, int parts_per_px,
               LinearImage& image);

}  // namespace flextip::simulation::render
