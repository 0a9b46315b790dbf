// A grid of AprilTags: the tags' corners in a picture, also where only a part is seen.
#pragma once

#include "calibration/boards/board.h"

namespace flextip {

/// The corners of the tags (36h11) that are read; frame and ids as in board.h.
BoardSighting FindAprilGrid(const Image& grey, const BoardSpec& board);

/// All of them (m, z = 0), by id.
std::vector<Eigen::Vector3d> AprilGridPoints(const BoardSpec& board);

}  // namespace flextip
