// Flat boards to calibrate from: what they are, and where they are seen in a picture.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"

namespace flextip {

enum class BoardKind { kChessboard, kCharuco, kAprilGrid };

/// A calibration board as given on the command line.
struct BoardSpec {
  BoardKind kind = BoardKind::kChessboard;
  int columns = 0, rows = 0;  ///< chessboard: inner corners; charuco: squares; aprilgrid: tags
  double square_m = 0.0;      ///< side of a square, for aprilgrid of a tag
  double marker_m = 0.0;      ///< charuco: side of a marker; aprilgrid: gap between tags
  std::string dictionary;     ///< charuco
};

/// Parses `chessboard:COLSxROWS:SQUARE_M`, `charuco:COLSxROWS:SQUARE_M:MARKER_M:DICT` or
/// `aprilgrid:COLSxROWS:TAG_M:GAP_M`; throws InputError saying which part is wrong.
BoardSpec ParseBoardSpec(const std::string& spec);

/// All corners that the board has, by id, in frame B (m, z = 0), and where they begin and end along
/// x and y.
std::vector<Eigen::Vector3d> BoardCorners(const BoardSpec& board);
std::pair<Eigen::Vector2d, Eigen::Vector2d> BoardExtent(const BoardSpec& board);

/// The corners seen in one picture. Frame B: origin at the board's first corner, x along its rows,
/// y along its columns, z into the board; all in the same order.
struct BoardSighting {
  std::vector<int> ids;              ///< of the corners on the board, ascending
  std::vector<Eigen::Vector3d> x_B;  ///< m, z = 0
  std::vector<Eigen::Vector2d> px;   ///< to a fraction of a pixel
  std::string reason;                ///< why there are none
  bool Found() const { return !px.empty(); }
};

/// Throws InputError for a kind that is not supported yet and for an empty picture. A chessboard is
/// seen whole or not at all, of the others any part that fixes a pose.
BoardSighting DetectBoard(const Image& image, const BoardSpec& board);

}  // namespace flextip
