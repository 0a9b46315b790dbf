// A board as it is printed: its black parts.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibration/boards/board.h"

namespace flextip {

/// Black rectangles on white, in frame B (m); x to the right, y down as the board is read.
struct BoardFace {
  std::vector<Eigen::AlignedBox2d> black;
  Eigen::AlignedBox2d extent;  ///< of the black parts
  double cell_m = 0.0;         ///< side of the smallest part: a square, or a marker's cell
  double margin_m = 0.0;       ///< white that the board needs around its black parts
};

/// Returns the face of a board. An even number of a charuco board's rows begins with a black square
/// unless the layout is `old`. An aprilgrid has black squares in the gaps' crossings, as Kalibr
/// prints them. Throws InputError where a dictionary or family has too few markers.
BoardFace FaceOf(const BoardSpec& board);

}  // namespace flextip
