#include "apps/calibrate/camera/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "apps/track/overlay.h"
#include "recording/frames/frames.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr double kLonger = 30.0;  // residuals are drawn so many times as long
constexpr int kShift = 4;         // fractional bits of a coordinate: lines between pixels
const cv::Scalar kGood(60, 170, 40), kBad(40, 40, 220), kArrow(178, 114, 0), kInk(51, 39, 29);

cv::Mat View(Image& image) {
  return cv::Mat(image.height_px, image.width_px, CV_8UC3, image.data.data());
}

cv::Point Fixed(const Eigen::Vector2d& px) {
  const double scale = 1 << kShift;
  return {static_cast<int>(std::lround(px.x() * scale)),
          static_cast<int>(std::lround(px.y() * scale))};
}

void DrawResiduals(cv::Mat& canvas, const SolvedView& view) {
  const double widest = 0.2 * canvas.cols;
  for (std::size_t i = 0; i < view.px.size(); ++i) {
    const cv::Scalar& color = view.IsUsed(i) ? kGood : kBad;
    cv::circle(canvas, Fixed(view.px[i]), 3 << kShift, color, 1, cv::LINE_AA, kShift);
    Eigen::Vector2d arrow = kLonger * view.residual_px[i];
    if (arrow.norm() > widest) arrow *= widest / arrow.norm();
    cv::line(canvas, Fixed(view.px[i]), Fixed(view.px[i] + arrow), view.IsUsed(i) ? kArrow : kBad,
             1, cv::LINE_AA, kShift);
  }
}

Image White(const CornersFile& corners) {
  Image image(corners.width_px, corners.height_px, 3);
  std::fill(image.data.begin(), image.data.end(), std::uint8_t{255});
  return image;
}

void DrawOverlays(const fs::path& folder, const CornersFile& corners,
                  const CameraCalibrationResult& result) {
  std::vector<const SolvedView*> solved(corners.views.size(), nullptr);
  for (const SolvedView& view : result.solution.views) solved[view.index] = &view;
  for (std::size_t i = 0; i < corners.views.size(); ++i) {
    const fs::path file = corners.views[i].name;
    if (!fs::exists(file)) continue;  // only its corners were kept
    Image image = ToColour(ReadImageFile(file));
    if (image.width_px != corners.width_px || image.height_px != corners.height_px) continue;
    if (solved[i]) {
      cv::Mat canvas = View(image);
      DrawResiduals(canvas, *solved[i]);
      DrawLabel(image, fmt::format("{:.3f} px", solved[i]->RmsPx()));
    } else {
      DrawPoints(image, corners.views[i].sighting.px);
      DrawLabel(image, result.views[i].reason);
    }
    WritePng(folder / "overlay" / fmt::format("{:04}_{}.png", i, file.stem().string()), image);
  }
}

void DrawAllResiduals(const fs::path& file, const CornersFile& corners, const CameraSolution& s) {
  Image image = White(corners);
  cv::Mat canvas = View(image);
  for (const SolvedView& view : s.views) DrawResiduals(canvas, view);
  WritePng(file, image);
}

void DrawCoverage(const fs::path& file, const CornersFile& corners, const CameraSolution& s) {
  constexpr int kAcross = 16, kDown = 9;
  Image image = White(corners);
  cv::Mat canvas = View(image);
  cv::Mat_<int> count(kDown, kAcross, 0);
  for (const SolvedView& view : s.views) {
    for (const Eigen::Vector2d& px : view.px) {
      const int x = static_cast<int>((px.x() + 0.5) / corners.width_px * kAcross),
                y = static_cast<int>((px.y() + 0.5) / corners.height_px * kDown);
      ++count(std::clamp(y, 0, kDown - 1), std::clamp(x, 0, kAcross - 1));
    }
  }
  const double most = std::max(1.0, *std::max_element(count.begin(), count.end()) * 1.0);
  for (int y = 0; y < kDown; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      const cv::Rect cell(
          cv::Point(x * canvas.cols / kAcross, y * canvas.rows / kDown),
          cv::Point((x + 1) * canvas.cols / kAcross, (y + 1) * canvas.rows / kDown));
      const double share = std::sqrt(count(y, x) / most);
      cv::rectangle(canvas, cell, cv::Scalar(255, 255 - 110 * share, 255 - 200 * share),
                    cv::FILLED);
      cv::putText(canvas, std::to_string(count(y, x)), cell.tl() + cv::Point(5, cell.height - 6),
                  cv::FONT_HERSHEY_SIMPLEX, 0.45, count(y, x) > 0 ? kInk : kBad, 1, cv::LINE_AA);
    }
  }
  WritePng(file, image);
}

}  // namespace

void DrawCameraPictures(const fs::path& folder, const CornersFile& corners,
                        const CameraCalibrationResult& result) {
  DrawOverlays(folder, corners, result);
  DrawAllResiduals(folder / "residuals.png", corners, result.solution);
  DrawCoverage(folder / "coverage.png", corners, result.solution);
}

}  // namespace flextip
