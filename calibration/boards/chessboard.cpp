#include "calibration/boards/chessboard.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "calibration/boards/saddles.h"

namespace flextip {
namespace {

double SmallestSpacing(const std::vector<cv::Point2f>& corners, int columns, int rows) {
  double smallest = HUGE_VAL;
  const auto at = [&](int row, int column) { return corners[row * columns + column]; };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (column > 0) {
        smallest = std::min(smallest, cv::norm(at(row, column) - at(row, column - 1)));
      }
      if (row > 0) smallest = std::min(smallest, cv::norm(at(row, column) - at(row - 1, column)));
    }
  }
  return smallest;
}

}  // namespace

std::vector<Eigen::Vector2d> FindChessboard(const Image& grey, int columns, int rows) {
  const cv::Mat picture(grey.height_px, grey.width_px, CV_8UC1,
                        const_cast<std::uint8_t*>(grey.data.data()));  // only read
  const cv::Size size(columns, rows);
  std::vector<cv::Point2f> corners;
  const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
  if (!cv::findChessboardCorners(picture, size, corners, flags)) return {};
  std::vector<Eigen::Vector2d> result;
  result.reserve(corners.size());
  for (const cv::Point2f& c : corners) result.emplace_back(c.x, c.y);
  const double reach_px = kSaddleReach * SmallestSpacing(corners, columns, rows);
  RefineSaddles(grey, reach_px, result);
  return result;
}

std::vector<Eigen::Vector3d> ChessboardPoints(int columns, int rows, double square_m) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      points.emplace_back(column * square_m, row * square_m, 0.0);
    }
  }
  return points;
}

}  // namespace flextip
