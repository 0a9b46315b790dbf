// Flat boards to calibrate from: their description, and their corners in a picture.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"

namespace flextip {

enum class BoardKind { kChessboard, kCharuco, kAprilGrid };

/// How a charuco board with an even number of rows begins, upper left: with a black square (OpenCV
/// from 4.6 on) or with a marker (before). With an odd number both are the same.
enum class CharucoLayout { kUnknown, kPresent, kOld };

/// A calibration board as given on the command line.
struct BoardSpec {
  BoardKind kind = BoardKind::kChessboard;
  int columns = 0, rows = 0;  ///< chessboard: inner corners; charuco: squares; aprilgrid: tags
  double square_m = 0.0;      ///< side of a square, for aprilgrid of a tag
  double marker_m = 0.0;      ///< charuco: side of a marker; aprilgrid: gap between tags
  std::string dictionary;     ///< charuco
  CharucoLayout layout = CharucoLayout::kUnknown;  ///< charuco; unknown: pictures tell
};

/// Parses `chessboard:COLSxROWS:SQUARE_M`,
/// `charuco:COLSxROWS:SQUARE_M:MARKER_M:DICT[:old|:present]` or `aprilgrid:COLSxROWS:TAG_M:GAP_M`;
/// throws InputError saying which part is wrong.
BoardSpec ParseBoardSpec(const std::string& spec);

/// Returns all corners of the board by id, in frame B (m, z = 0), and their first and last place
/// along x and y.
std::vector<Eigen::Vector3d> BoardCorners(const BoardSpec& board);
std::pair<Eigen::Vector2d, Eigen::Vector2d> BoardExtent(const BoardSpec& board);

/// The corners seen in one picture. Frame B: x to the right along the rows and y down as the board
/// is read, z into it. Corners and ids:
/// - chessboard: inner corners row by row; the origin is the first one;
/// - charuco: inner corners row by row, the origin is the outer corner of the first square, both as
///   in OpenCV from 4.6 on. The layout is told from the picture where it shows enough;
/// - aprilgrid: tag t has the corners 4 t ... 4 t + 3: lower left, lower right, upper right, upper
///   left. Tags count from the lower left one along the rows and then up, as Kalibr prints them;
///   the origin is the upper left corner of the upper left tag (Kalibr: the lower left corner of
///   the lower left tag, y up). The same order within each list.
struct BoardSighting {
  std::vector<int> ids;                            ///< of the corners on the board, ascending
  std::vector<Eigen::Vector3d> x_B;                ///< m, z = 0
  std::vector<Eigen::Vector2d> px;                 ///< to a fraction of a pixel
  std::string reason;                              ///< why there are none
  CharucoLayout layout = CharucoLayout::kUnknown;  ///< of a charuco board, where this picture tells
  bool Found() const { return !px.empty(); }
};

/// One picture of the board with the name it goes by in messages.
struct BoardView {
  std::string name;
  BoardSighting sighting;
};

/// Throws InputError for an empty picture and a dictionary that there is not or that has too few
/// markers. A chessboard is seen whole or not at all, of the others any part.
BoardSighting DetectBoard(const Image& image, const BoardSpec& board);

}  // namespace flextip
