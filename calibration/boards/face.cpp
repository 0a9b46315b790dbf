#include "calibration/boards/face.h"

#include "calibration/boards/charuco.h"
#include "core/error.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

using Eigen::Vector2d;

void AddSquare(const Vector2d& corner, double side_m, BoardFace& face) {
  face.black.emplace_back(corner, corner + Vector2d::Constant(side_m));
}

/// The black cells of a marker whose upper left corner is at `corner`, a row's neighbours joined.
template <class IsBlack>
void AddCells(const Vector2d& corner, double cell_m, int cells, const IsBlack& is_black,
              BoardFace& face) {
  for (int row = 0; row < cells; ++row) {
    for (int from = 0; from < cells; ++from) {
      int to = from;
      while (to < cells && is_black(to, row)) ++to;
      if (to == from) continue;
      face.black.emplace_back(corner + cell_m * Vector2d(from, row),
                              corner + cell_m * Vector2d(to, row + 1));
      from = to;
    }
  }
}

void AddChessboard(const BoardSpec& board, BoardFace& face) {
  const double side = board.square_m;
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = row % 2; column <= board.columns; column += 2) {
      AddSquare(side * Vector2d(column - 1, row - 1), side, face);
    }
  }
  face.cell_m = face.margin_m = side;
}

void AddCharuco(const BoardSpec& board, BoardFace& face) {
  CheckCharuco(board);
  const bool old = board.rows % 2 == 0 && board.layout == CharucoLayout::kOld;
  const double gap = 0.5 * (board.square_m - board.marker_m);
  int id = 0;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const Vector2d corner = board.square_m * Vector2d(column, row);
      if ((column + row) % 2 == (old ? 1 : 0)) {
        AddSquare(corner, board.square_m, face);
        continue;
      }
      const CharucoMarker marker = ReadCharucoMarker(board, id++);
      face.cell_m = board.marker_m / marker.cells;
      AddCells(
          corner + Vector2d(gap, gap), face.cell_m, marker.cells,
          [&](int c, int r) { return marker.IsBlack(c, r); }, face);
    }
  }
  face.margin_m = 0.5 * board.square_m;
}

void AddAprilGrid(const BoardSpec& board, BoardFace& face) {
  const double pitch = board.square_m + board.marker_m;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      const TagCells tag = ReadTagCells("tag36h11", row * board.columns + column);
      const int rim = (tag.cells - tag.border_cells) / 2;
      face.cell_m = board.square_m / tag.border_cells;
      AddCells(
          pitch * Vector2d(column, board.rows - 1 - row), face.cell_m, tag.border_cells,
          [&](int c, int r) { return tag.At(c + rim, r + rim) == TagCells::kBlack; }, face);
    }
  }
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      const Vector2d crossing = pitch * Vector2d(column, row) - Vector2d::Constant(board.marker_m);
      AddSquare(crossing, board.marker_m, face);
    }
  }
  face.margin_m = board.marker_m;
}

}  // namespace

BoardFace FaceOf(const BoardSpec& board) {
  BoardFace face;
  if (board.kind == BoardKind::kCharuco) {
    AddCharuco(board, face);
  } else if (board.kind == BoardKind::kAprilGrid) {
    AddAprilGrid(board, face);
  } else {
    AddChessboard(board, face);
  }
  for (const auto& box : face.black) face.extent.extend(box);
  return face;
}

}  // namespace flextip
