#include "apps/common/drawing.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace flextip {
namespace {

constexpr int kFractionBits = 4;  // OpenCV draws to 1/16 px

cv::Mat View(Image& image) {
  return cv::Mat(image.height_px, image.width_px, CV_8UC3, image.data.data());
}

cv::Scalar Bgr(const Colour& colour) { return {colour.blue, colour.green, colour.red}; }

cv::Point Fine(const Eigen::Vector2d& px) {
  const double scale = 1 << kFractionBits;
  return {static_cast<int>(std::lround(px.x() * scale)),
          static_cast<int>(std::lround(px.y() * scale))};
}

void Circle(Image& image, const Eigen::Vector2d& middle, int radius_px, const Colour& colour,
            int thickness_px) {
  cv::Mat canvas = View(image);
  cv::circle(canvas, Fine(middle), radius_px << kFractionBits, Bgr(colour), thickness_px,
             cv::LINE_AA, kFractionBits);
}

}  // namespace

void Drawing::Line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Colour& colour,
                   int thickness_px) {
  cv::Mat canvas = View(image_);
  cv::line(canvas, Fine(a), Fine(b), Bgr(colour), thickness_px, cv::LINE_AA, kFractionBits);
}

void Drawing::Cross(const Eigen::Vector2d& middle, double arm_px, const Colour& colour) {
  const Eigen::Vector2d along(arm_px, 0), up(0, arm_px);
  Line(middle - along, middle + along, colour);
  Line(middle - up, middle + up, colour);
}

void Drawing::Ring(const Eigen::Vector2d& middle, int radius_px, const Colour& colour,
                   int thickness_px) {
  Circle(image_, middle, radius_px, colour, thickness_px);
}

void Drawing::Disc(const Eigen::Vector2d& middle, int radius_px, const Colour& colour) {
  Circle(image_, middle, radius_px, colour, cv::FILLED);
}

void Drawing::Ellipse(const Eigen::Vector2d& middle, const Eigen::Vector2d& half_axes_px,
                      double angle_deg, const Colour& colour) {
  cv::Mat canvas = View(image_);
  const cv::Point size = Fine(half_axes_px);
  cv::ellipse(canvas, Fine(middle), cv::Size(size.x, size.y), angle_deg, 0, 360, Bgr(colour), 1,
              cv::LINE_AA, kFractionBits);
}

void Drawing::Text(const std::string& text, const Eigen::Vector2i& begin, double scale,
                   const Colour& colour) {
  cv::Mat canvas = View(image_);
  const cv::Point at(begin.x(), begin.y());
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(0, 0, 0), 3,
              cv::LINE_AA);
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, Bgr(colour), 1, cv::LINE_AA);
}

void Drawing::Label(const std::string& text) { Text(text, {8, 22}, 0.6, {255, 255, 255}); }

}  // namespace flextip
