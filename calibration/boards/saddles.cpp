#include "calibration/boards/saddles.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace flextip {
namespace {

constexpr int kMinHalfWindow_px = 2, kMaxHalfWindow_px = 40;

}  // namespace

void RefineSaddles(const Image& grey, double reach_px, std::vector<Eigen::Vector2d>& px) {
  if (px.empty()) return;
  const cv::Mat picture(grey.height_px, grey.width_px, CV_8UC1,
                        const_cast<std::uint8_t*>(grey.data.data()));  // only read
  std::vector<cv::Point2f> corners;
  corners.reserve(px.size());
  for (const Eigen::Vector2d& p : px) {
    corners.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  const int half =
      std::clamp(static_cast<int>(std::lround(reach_px)), kMinHalfWindow_px, kMaxHalfWindow_px);
  cv::cornerSubPix(picture, corners, cv::Size(half, half), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-4));
  for (std::size_t i = 0; i < px.size(); ++i) px[i] = {corners[i].x, corners[i].y};
}

}  // namespace flextip
