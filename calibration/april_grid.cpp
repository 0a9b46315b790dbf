#include "calibration/april_grid.h"

#include "core/error.h"
#include "vision/tag_detector.h"

namespace flextip {

std::vector<Eigen::Vector3d> AprilGridPoints(const BoardSpec& board) {
  const double side = board.square_m, pitch = side + board.marker_m;
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < board.rows; ++row) {
    const double bottom = (board.rows - 1 - row) * pitch + side;  // the first row is the lowest
    for (int column = 0; column < board.columns; ++column) {
      const double left = column * pitch;
      points.emplace_back(left, bottom, 0.0);
      points.emplace_back(left + side, bottom, 0.0);
      points.emplace_back(left + side, bottom - side, 0.0);
      points.emplace_back(left, bottom - side, 0.0);
    }
  }
  return points;
}

BoardSighting FindAprilGrid(const Image& grey, const BoardSpec& board) {
  const auto points = AprilGridPoints(board);
  const int tags = board.columns * board.rows;
  BoardSighting seen;
  int last = -1, unrefined = 0;
  for (const TagDetection& tag : TagDetector().Detect(grey)) {
    if (tag.id >= tags || tag.id == last) continue;
    if (!tag.refined) {
      ++unrefined;
      continue;
    }
    last = tag.id;
    for (int k = 0; k < 4; ++k) {
      const int id = 4 * tag.id + k;
      seen.ids.push_back(id);
      seen.x_B.push_back(points[static_cast<std::size_t>(id)]);
      seen.px.push_back(tag.corners_px[static_cast<std::size_t>(k)]);
    }
  }
  if (!seen.Found()) {
    seen.reason = fmt::format("no tag of the {}x{} grid found", board.columns, board.rows);
    if (unrefined > 0) seen.reason += fmt::format(" whose edges could be fitted ({})", unrefined);
  }
  return seen;
}

}  // namespace flextip
