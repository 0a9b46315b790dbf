#include "apps/shape/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/check.h"

namespace flextip {
namespace {

using report::FigureTrace;

constexpr double kMmPerM = 1000.0;
constexpr double kArrowShare = 0.15;  // of what is seen
constexpr const char* kInk = "#1d2733";
constexpr const char* kQuiet = "#828c96";
constexpr const char* kShaft = "#0072b2";
constexpr const char* kForce = "#d55e00";
constexpr const char* kPort = "#009e73";

/// Two of R's axes.
struct View {
  int u = 0, v = 0;

  void Add(const Eigen::Vector3d& p, FigureTrace& trace) const {
    trace.x.push_back(kMmPerM * p[u]);
    trace.y.push_back(kMmPerM * p[v]);
  }
  FigureTrace Point(const Eigen::Vector3d& p, const char* name, const char* color) const {
    FigureTrace trace{.kind = FigureTrace::Kind::kPoints, .texts = {name}, .color = color};
    Add(p, trace);
    return trace;
  }
};

double Extent(const Shape& shape) {
  Eigen::Array3d low = shape.points.front(), high = low;
  for (const auto& p : shape.points) {
    low = low.min(p.array());
    high = high.max(p.array());
  }
  return (high - low).maxCoeff();
}

report::Figure Draw(const View& view, const char* name, const char* title,
                    const RodProblem& problem, const Shape& shape) {
  FigureTrace unloaded{.name = "unloaded shaft", .color = kQuiet, .dashed = true};
  const Eigen::Vector3d to_port = (problem.p_port - problem.p_wrist).normalized();
  view.Add(problem.p_wrist, unloaded);
  view.Add(problem.p_wrist + to_port * problem.length_m, unloaded);
  FigureTrace shaft{.name = "shaft", .color = kShaft};
  for (const auto& p : shape.points) view.Add(p, shaft);
  constexpr std::array kAxes{"x (mm)", "y (mm)", "z (mm)"};
  report::Figure figure{.name = name,
                        .title = title,
                        .x_label = kAxes[view.u],
                        .y_label = kAxes[view.v],
                        .equal_axes = true};
  figure.traces = {unloaded, shaft, view.Point(problem.p_wrist, "wrist", kInk),
                   view.Point(problem.p_port, "port", kPort),
                   view.Point(shape.p_tip, "tip", kShaft)};
  const double force_N = problem.f_tip.norm();
  const Eigen::Vector2d seen(problem.f_tip[view.u], problem.f_tip[view.v]);
  if (force_N > 0 && seen.norm() >= 0.05 * force_N) {  // else it points at the viewer
    FigureTrace force{
        .name = fmt::format("force on the tip, {:.3g} N", force_N), .color = kForce, .arrow = true};
    view.Add(shape.p_tip - kArrowShare * Extent(shape) / force_N * problem.f_tip, force);
    view.Add(shape.p_tip, force);
    figure.traces.push_back(force);
  }
  return figure;
}

}  // namespace

std::vector<report::Figure> ShapeFigures(const RodProblem& problem, const Shape& shape) {
  FLEXTIP_CHECK(shape.IsUsable(), "a solved shape");
  return {Draw({0, 2}, "side-view", "Side view", problem, shape),
          Draw({0, 1}, "top-view", "Top view", problem, shape)};
}

}  // namespace flextip
