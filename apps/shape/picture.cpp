#include "apps/shape/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/check.h"
#include "core/error.h"

namespace flextip {
namespace {

constexpr int kWidth_px = 1200, kPanelHeight_px = 460;
constexpr int kLeft_px = 90, kRight_px = 40, kTop_px = 56, kBottom_px = 64;
constexpr double kMmPerM = 1000.0;
constexpr int kShift = 4;  // fractional bits of a coordinate: lines between pixels
const cv::Scalar kInk(51, 39, 29), kQuiet(150, 140, 130), kGrid(237, 232, 227);
const cv::Scalar kShaft(178, 114, 0), kForce(0, 94, 213), kPort(115, 158, 0);

/// One view: two of R's axes, in mm, onto a rectangle of the picture with one scale for both.
class Panel {
 public:
  Panel(cv::Mat& picture, int top_px, int axis_u, int axis_v)
      : picture_(picture), top_px_(top_px), u_(axis_u), v_(axis_v) {}

  void Fit(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Array2d low = Flat(points.front()), high = low;
    for (const auto& p : points) {
      low = low.min(Flat(p));
      high = high.max(Flat(p));
    }
    const Eigen::Array2d span = (high - low).max(1.0) * 1.12;
    px_per_mm_ = std::min(InnerWidth() / span.x(), InnerHeight() / span.y());
    middle_mm_ = 0.5 * (low + high);
  }

  cv::Point At(const Eigen::Vector3d& p) const { return At(Flat(p)); }

  void Line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const cv::Scalar& color,
            int width) const {
    cv::line(picture_, At(a), At(b), color, width, cv::LINE_AA, kShift);
  }

  void Dashes(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const cv::Scalar& color) const {
    constexpr int kDashes = 40;
    for (int i = 0; i < kDashes; ++i) {
      Line(a + (b - a) * (double(i) / kDashes), a + (b - a) * ((i + 0.5) / kDashes), color, 1);
    }
  }

  void Dot(const Eigen::Vector3d& p, const cv::Scalar& color, const std::string& label) const {
    cv::circle(picture_, At(p), 7 << kShift, color, cv::FILLED, cv::LINE_AA, kShift);
    Text(label, Pixel(p) + cv::Point(12, -12), 0.55, kInk);
  }

  /// An arrow that ends on `p`, as long as `share` of the panel's height.
  void Arrow(const Eigen::Vector3d& p, const Eigen::Vector3d& direction, double share,
             const std::string& label) const {
    const Eigen::Array2d flat = Flat(direction) / kMmPerM;
    const double length_mm = share * InnerHeight() / px_per_mm_;
    const Eigen::Array2d begin = Flat(p) - flat * length_mm;
    if (flat.matrix().norm() < 0.05) return;  // it points at the viewer
    cv::arrowedLine(picture_, Pixel(begin), Pixel(Flat(p)), kForce, 3, cv::LINE_AA, 0, 0.18);
    Text(label, Pixel(begin) + cv::Point(10, 5), 0.5, kForce);
  }

  void Axes(const std::string& title) const {
    Text(title, {kLeft_px, top_px_ + 34}, 0.7, kInk);
    const Eigen::Array2d half = 0.5 * Eigen::Array2d(InnerWidth(), InnerHeight()) / px_per_mm_;
    const double step = NiceStep(2.0 * half.maxCoeff() / 9.0);
    for (double x = First(middle_mm_.x() - half.x(), step); x <= middle_mm_.x() + half.x();
         x += step) {
      Tick({x, middle_mm_.y() - half.y()}, {x, middle_mm_.y() + half.y()}, x, {-16, 20});
    }
    for (double y = First(middle_mm_.y() - half.y(), step); y <= middle_mm_.y() + half.y();
         y += step) {
      Tick({middle_mm_.x() - half.x(), y}, {middle_mm_.x() + half.x(), y}, y, {-52, 5});
    }
    constexpr std::array kNames{"x", "y", "z"};
    Text(fmt::format("{} (mm)", kNames[u_]), {kWidth_px / 2, top_px_ + kPanelHeight_px - 14}, 0.5,
         kInk);
    Text(fmt::format("{} (mm)", kNames[v_]), {10, top_px_ + kTop_px - 8}, 0.5, kInk);
  }

 private:
  static double InnerWidth() { return kWidth_px - kLeft_px - kRight_px; }
  static double InnerHeight() { return kPanelHeight_px - kTop_px - kBottom_px; }
  Eigen::Array2d Flat(const Eigen::Vector3d& p) const { return {p[u_] * kMmPerM, p[v_] * kMmPerM}; }

  Eigen::Array2d Place(const Eigen::Array2d& mm) const {
    const Eigen::Array2d from_middle = (mm - middle_mm_) * px_per_mm_;
    return {kLeft_px + 0.5 * InnerWidth() + from_middle.x(),
            top_px_ + kTop_px + 0.5 * InnerHeight() - from_middle.y()};
  }
  cv::Point At(const Eigen::Array2d& mm) const {
    const Eigen::Array2d px = Place(mm) * (1 << kShift);
    return {cvRound(px.x()), cvRound(px.y())};
  }
  cv::Point Pixel(const Eigen::Array2d& mm) const {
    const Eigen::Array2d px = Place(mm);
    return {cvRound(px.x()), cvRound(px.y())};
  }
  cv::Point Pixel(const Eigen::Vector3d& p) const { return Pixel(Flat(p)); }

  static double First(double low, double step) { return std::ceil(low / step) * step; }
  static double NiceStep(double about) {
    const double power = std::pow(10.0, std::floor(std::log10(about)));
    for (const double m : {1.0, 2.0, 5.0}) {
      if (m * power >= about) return m * power;
    }
    return 10.0 * power;
  }

  void Tick(const Eigen::Array2d& a, const Eigen::Array2d& b, double value,
            cv::Point offset) const {
    cv::line(picture_, At(a), At(b), kGrid, 1, cv::LINE_AA, kShift);
    const double shown = std::abs(value) < 1e-9 ? 0.0 : value;
    Text(fmt::format("{:.6g}", shown), Pixel(a) + offset, 0.45, kInk);
  }

  void Text(const std::string& text, cv::Point at, double size, const cv::Scalar& color) const {
    cv::putText(picture_, text, at, cv::FONT_HERSHEY_SIMPLEX, size, color, 1, cv::LINE_AA);
  }

  cv::Mat& picture_;
  int top_px_, u_, v_;
  double px_per_mm_ = 1.0;
  Eigen::Array2d middle_mm_ = Eigen::Array2d::Zero();
};

void DrawPanel(const Panel& panel, const std::string& title, const RodProblem& problem,
               const Shape& shape) {
  panel.Axes(title);
  const Eigen::Vector3d to_port = (problem.p_port - problem.p_wrist).normalized();
  panel.Dashes(problem.p_wrist, problem.p_wrist + to_port * problem.length_m, kQuiet);
  for (std::size_t i = 1; i < shape.points.size(); ++i) {
    panel.Line(shape.points[i - 1], shape.points[i], kShaft, 4);
  }
  panel.Dot(problem.p_wrist, kInk, "wrist");
  panel.Dot(problem.p_port, kPort, "port");
  panel.Dot(shape.p_tip, kShaft, "tip");
  const double force = problem.f_tip.norm();
  if (force > 0) {
    panel.Arrow(shape.p_tip, problem.f_tip / force, 0.3, fmt::format("{:.3g} N", force));
  }
}

}  // namespace

std::string DrawShape(const RodProblem& problem, const Shape& shape) {
  FLEXTIP_CHECK(shape.IsUsable(), "a solved shape");
  cv::Mat picture(2 * kPanelHeight_px, kWidth_px, CV_8UC3, cv::Scalar(255, 255, 255));
  std::vector<Eigen::Vector3d> seen = shape.points;
  seen.push_back(problem.p_port);
  const Eigen::Vector3d to_port = (problem.p_port - problem.p_wrist).normalized();
  seen.emplace_back(problem.p_wrist + to_port * problem.length_m);
  Panel side(picture, 0, 0, 2), top(picture, kPanelHeight_px, 0, 1);
  side.Fit(seen);
  top.Fit(seen);
  DrawPanel(side, "Side view (dashed: the unloaded shaft)", problem, shape);
  DrawPanel(top, "Top view", problem, shape);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes)) throw WorkError("the picture cannot be encoded");
  return {bytes.begin(), bytes.end()};
}

}  // namespace flextip
