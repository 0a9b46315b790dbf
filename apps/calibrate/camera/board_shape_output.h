// A board's own shape as summaries and pages tell it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "calibration/camera/solution.h"
#include "report/figure.h"

namespace flextip {

/// `estimated`, `reason` and, where it was estimated, `rms_m`, `longest_m`, `prior_sd_m` and
/// `offsets_m` (id, x, y, z of each corner).
nlohmann::json BoardShapeJson(const BoardShape& shape, const std::string& reason);

/// Adds a picture of the board seen from the front: in colours how far behind its plane it is, in
/// lines where each corner is, exaggerated. `x_B` by id. Nothing where the board is as described.
void AddBoardFigure(const std::vector<Eigen::Vector3d>& x_B, const BoardWarp& warp,
                    const BoardShape& shape, std::vector<report::Figure>& figures);

}  // namespace flextip
