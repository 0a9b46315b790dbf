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

/// A marker with its black border: `cells` x `cells`, as it is read.
struct CharucoMarker {
  int cells = 0;
  std::vector<bool> black = {};  ///< rows from the top

  bool IsBlack(int column, int row) const {
    return black[static_cast<std::size_t>(row) * cells + column];
  }
};

/// Returns the marker of that id in the board's dictionary. Throws InputError as FindCharuco.
CharucoMarker ReadCharucoMarker(const BoardSpec& board, int id);

}  // namespace flextip
