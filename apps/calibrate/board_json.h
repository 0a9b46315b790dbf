// A board's own shape as summaries tell it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "calibration/camera/camera_solution.h"

namespace flextip {

/// `estimated`, `reason` and, where it was estimated, `rms_m`, `longest_m`, `prior_sd_m` and
/// `offsets_m` (id, x, y, z of each corner).
nlohmann::json BoardShapeJson(const BoardShape& shape, const std::string& reason);

}  // namespace flextip
