#include "apps/calibrate/camera/corner_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/calibrate/camera/pictures.h"

namespace flextip {
namespace {

using report::FigureTrace;

constexpr std::size_t kMostCorners = 4000;  // more are no longer told apart on a page
constexpr int kAcross = 16, kDown = 9;      // parts of the picture
constexpr const char* kGood = "#28aa3c";
constexpr const char* kBad = "#dc2828";
constexpr const char* kArrow = "#0072b2";
constexpr const char* kQuiet = "#9aa5b1";

report::Figure OverThePicture(const char* name, const char* title) {
  return {.name = name,
          .title = title,
          .x_label = "x (px)",
          .y_label = "y (px)",
          .y_down = true,
          .equal_axes = true};
}

FigureTrace Border(const CornersFile& corners) {
  const double right = corners.width_px - 0.5, low = corners.height_px - 0.5;
  return {
      .x = {-0.5, right, right, -0.5, -0.5}, .y = {-0.5, -0.5, low, low, -0.5}, .color = kQuiet};
}

void AddPoint(const Eigen::Vector2d& px, FigureTrace& trace) {
  const auto shown = [](double v) { return std::round(100.0 * v) / 100.0; };
  trace.x.push_back(shown(px.x()));
  trace.y.push_back(shown(px.y()));
}

void AddGap(FigureTrace& trace) {
  trace.x.push_back(std::numeric_limits<double>::quiet_NaN());
  trace.y.push_back(std::numeric_limits<double>::quiet_NaN());
}

/// Corners of one kind, and their residuals.
struct Corners {
  Corners(const char* name, const char* points_color, const char* lines_name,
          const char* lines_color)
      : points{.name = name,
               .kind = FigureTrace::Kind::kPoints,
               .color = points_color,
               .symbol = "circle-open"},
        residuals{.name = lines_name, .color = lines_color} {}

  void Add(const Eigen::Vector2d& px, const Eigen::Vector2d& end) {
    AddPoint(px, points);
    AddPoint(px, residuals);
    AddPoint(end, residuals);
    AddGap(residuals);
  }

  FigureTrace points, residuals;
};

}  // namespace

report::Figure ResidualsFigure(const CornersFile& corners, const CameraSolution& solution) {
  const std::size_t used = solution.CornersUsed();
  const std::size_t every = std::max<std::size_t>(1, (used + kMostCorners - 1) / kMostCorners);
  Corners good("corners used", kGood, "residuals", kArrow), bad("outliers", kBad, "", kBad);
  std::size_t count = 0;
  for (const SolvedView& view : solution.views) {
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      if (view.IsUsed(i) && count++ % every != 0) continue;
      (view.IsUsed(i) ? good : bad)
          .Add(view.px[i], view.px[i] + DrawnResidual(view.residual_px[i], corners.width_px));
    }
  }
  report::Figure figure = OverThePicture("residuals", "Residuals of all views");
  figure.caption =
      fmt::format("Residuals are drawn {:.0f} times as long as they are{}.", kResidualsLonger,
                  every == 1 ? "" : fmt::format("; one of {} corners used", every));
  figure.traces = {Border(corners), good.points, good.residuals};
  if (!bad.points.x.empty()) {
    figure.traces.push_back(bad.points);
    figure.traces.push_back(bad.residuals);
  }
  return figure;
}

report::Figure CoverageFigure(const CornersFile& corners, const CameraSolution& solution) {
  report::FigureField field{.name = "corners", .low = 0.0, .cells = true};
  for (int i = 0; i < kAcross; ++i) field.x.push_back((i + 0.5) * corners.width_px / kAcross - 0.5);
  for (int i = 0; i < kDown; ++i) field.y.push_back((i + 0.5) * corners.height_px / kDown - 0.5);
  field.values.assign(kAcross * kDown, 0.0);
  for (const SolvedView& view : solution.views) {
    for (const Eigen::Vector2d& px : view.px) {
      const int x = static_cast<int>((px.x() + 0.5) / corners.width_px * kAcross),
                y = static_cast<int>((px.y() + 0.5) / corners.height_px * kDown);
      ++field.values[std::clamp(y, 0, kDown - 1) * kAcross + std::clamp(x, 0, kAcross - 1)];
    }
  }
  FigureTrace unseen{.name = "no corner",
                     .kind = FigureTrace::Kind::kPoints,
                     .color = kBad,
                     .symbol = "x-thin-open"};
  for (int y = 0; y < kDown; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      double& count = field.values[y * kAcross + x];
      if (count > 0) continue;
      count = std::numeric_limits<double>::quiet_NaN();
      unseen.x.push_back(field.x[x]);
      unseen.y.push_back(field.y[y]);
    }
  }
  report::Figure figure = OverThePicture("coverage", "Where corners were seen");
  figure.caption = "How many corners of all views each part of the picture has seen.";
  figure.fields = {field};
  if (!unseen.x.empty()) figure.traces = {unseen};
  return figure;
}

}  // namespace flextip
