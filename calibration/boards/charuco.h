// A chessboard with markers in its white squares: its inner corners in a picture, also where only a
// part is seen.
#pragma once

#include "calibration/boards/board.h"

namespace flextip {

/// The inner corners, row by row as OpenCV counts them (ids from 0), that lie beside two markers
/// that were read. Throws InputError for a dictionary that OpenCV does not have, or that has too
/// few markers for the board.
BoardSighting FindCharuco(const Image& grey, const BoardSpec& board);

/// All of them (m, z = 0), by id; the origin is the outer corner of the first square.
std::vector<Eigen::Vector3d> CharucoPoints(const BoardSpec& board);

/// Throws InputError as FindCharuco.
void CheckCharuco(const BoardSpec& board);

}  // namespace flextip
