#include "calibration/boards/april_grid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "calibration/boards/saddles.h"
#include "core/error.h"
#include "vision/tags/detector.h"
#include "vision/tags/edge_refiner.h"

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

namespace {

constexpr int kCellsAcross = 8;  // of 36h11, border to border

// Black shapes a pixel smaller all around: Kalibr's squares in the crossings touch the tags, which
// are then no quadrilaterals of their own.
Image Thinned(const Image& grey) {
  Image thin = grey;
  cv::Mat from(grey.height_px, grey.width_px, CV_8UC1,
               const_cast<std::uint8_t*>(grey.data.data()));  // only read
  cv::Mat to(thin.height_px, thin.width_px, CV_8UC1, thin.data.data());
  cv::dilate(from, to, cv::Mat());
  return thin;
}

// Tags by id, their corners fitted to the edges in `grey`.
std::map<int, TagCorners> FindTags(const Image& grey, int count) {
  TagDetector detector({.max_hamming = 1, .refine_corners = false});
  std::map<int, TagCorners> tags;
  for (const Image& image : {grey, Thinned(grey)}) {
    for (const TagDetection& tag : detector.Detect(image)) {
      if (tag.id >= count || tags.contains(tag.id)) continue;
      const RefinedQuad quad = RefineCorners(grey, tag.corners_px, kCellsAcross);
      if (quad.edges_fitted == 4) tags[tag.id] = quad.corners_px;
    }
  }
  return tags;
}

double GreyAt(const Image& grey, const Eigen::Vector2d& px) {
  const auto x = std::lround(px.x()), y = std::lround(px.y());
  if (x < 0 || y < 0 || x >= grey.width_px || y >= grey.height_px) return 255.0;
  return grey.Row(static_cast<int>(y))[x];
}

// Where a black square touches the corner, as Kalibr prints them, it is a saddle: better than the
// edges, whose ends the square disturbs.
void RefineTouched(const Image& grey, double gap_of_side, TagCorners& corners_px) {
  const TagCorners edges = corners_px;
  const Eigen::Vector2d centre = 0.25 * (edges[0] + edges[1] + edges[2] + edges[3]);
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d &corner = edges[k], &next = edges[(k + 1) % 4];
    const Eigen::Vector2d middle = 0.5 * (corner + next);
    const double crossing = GreyAt(grey, corner + gap_of_side * (corner - centre)),
                 gap = GreyAt(grey, middle + gap_of_side * (middle - centre)),
                 border = GreyAt(grey, corner - (corner - centre) / kCellsAcross);
    if (crossing > 0.5 * (gap + border)) continue;
    const double side_px = std::min((next - corner).norm(), (edges[(k + 3) % 4] - corner).norm());
    std::vector<Eigen::Vector2d> one = {corner};
    RefineSaddles(grey, 0.8 * side_px * std::min(1.0 / kCellsAcross, gap_of_side), one);
    corners_px[k] = one[0];
  }
}

}  // namespace

BoardSighting FindAprilGrid(const Image& grey, const BoardSpec& board) {
  const auto points = AprilGridPoints(board);
  BoardSighting seen;
  for (auto& [tag, corners_px] : FindTags(grey, board.columns * board.rows)) {
    RefineTouched(grey, board.marker_m / board.square_m, corners_px);
    for (int k = 0; k < 4; ++k) {
      seen.ids.push_back(4 * tag + k);
      seen.x_B.push_back(points[static_cast<std::size_t>(seen.ids.back())]);
      seen.px.push_back(corners_px[static_cast<std::size_t>(k)]);
    }
  }
  if (!seen.Found()) {
    seen.reason = fmt::format("no tag of the {}x{} grid found", board.columns, board.rows);
  }
  return seen;
}

}  // namespace flextip
