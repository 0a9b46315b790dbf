// A chessboard's inner corners in a picture.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/image.h"

namespace flextip {

/// The inner corners row by row, to a fraction of a pixel (pixel (0,0) is a pixel's centre); empty
/// where the whole board is not seen.
std::vector<Eigen::Vector2d> FindChessboard(const Image& grey, int columns, int rows);

/// Points of the board (m), z = 0, in the order of FindChessboard.
std::vector<Eigen::Vector3d> ChessboardPoints(int columns, int rows, double square_m);

}  // namespace flextip
