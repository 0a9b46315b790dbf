#include "calibration/boards/board.h"

#include "calibration/boards/april_grid.h"
#include "calibration/boards/charuco.h"
#include "calibration/boards/chessboard.h"
#include "core/error.h"
#include "vision/tags/detector.h"

namespace flextip {

std::vector<Eigen::Vector3d> BoardCorners(const BoardSpec& board) {
  switch (board.kind) {
    case BoardKind::kCharuco:
      CheckCharuco(board);
      return CharucoPoints(board);
    case BoardKind::kAprilGrid:
      return AprilGridPoints(board);
    case BoardKind::kChessboard:
      break;
  }
  return ChessboardPoints(board.columns, board.rows, board.square_m);
}

std::pair<Eigen::Vector2d, Eigen::Vector2d> BoardExtent(const BoardSpec& board) {
  const auto corners = BoardCorners(board);
  Eigen::Vector2d low = corners.front().head<2>(), high = low;
  for (const Eigen::Vector3d& x : corners) {
    low = low.cwiseMin(x.head<2>());
    high = high.cwiseMax(x.head<2>());
  }
  return {low, high};
}

BoardSighting DetectBoard(const Image& image, const BoardSpec& board) {
  if (image.Empty()) throw InputError("the image is empty");
  const Image grey = ToGrey(image);
  if (board.kind == BoardKind::kCharuco) return FindCharuco(grey, board);
  if (board.kind == BoardKind::kAprilGrid) return FindAprilGrid(grey, board);
  BoardSighting seen;
  seen.px = FindChessboard(grey, board.columns, board.rows);
  if (!seen.Found()) {
    seen.reason =
        fmt::format("no chessboard with {}x{} inner corners found", board.columns, board.rows);
    return seen;
  }
  seen.x_B = ChessboardPoints(board.columns, board.rows, board.square_m);
  for (std::size_t i = 0; i < seen.px.size(); ++i) seen.ids.push_back(static_cast<int>(i));
  return seen;
}

}  // namespace flextip
