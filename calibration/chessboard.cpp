#include "calibration/chessboard.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace flextip {
namespace {

// The saddle at a corner is refined in a window of this part of the distance to the next corner. A
// larger one reaches into the neighbours' edges where the board is tilted, and is pulled by them.
constexpr double kWindowOfSpacing = 0.33;
constexpr int kMinHalfWindow_px = 2, kMaxHalfWindow_px = 40;

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
  const double spacing = SmallestSpacing(corners, columns, rows);
  const int half = std::clamp(static_cast<int>(std::lround(kWindowOfSpacing * spacing)),
                              kMinHalfWindow_px, kMaxHalfWindow_px);
  cv::cornerSubPix(picture, corners, cv::Size(half, half), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-4));
  std::vector<Eigen::Vector2d> result;
  result.reserve(corners.size());
  for (const cv::Point2f& c : corners) result.emplace_back(c.x, c.y);
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
