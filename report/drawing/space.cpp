#include "report/drawing/space.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace flextip::report {
namespace {

/// A parallel view of a box.
struct View {
  Eigen::Vector3d right, up;
  Eigen::Vector3d low, high;  ///< of the box
  double px_per_unit = 1.0;
  Place middle;

  Place At(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d from_middle = p - 0.5 * (low + high);
    return {middle.x + px_per_unit * right.dot(from_middle),
            middle.y - px_per_unit * up.dot(from_middle)};
  }
};

/// Returns a view from (1.15, -1.5, 0.8) on the box around all points; no side of it is shorter
/// than a quarter of the longest.
View Fit(const Figure& figure, const PlotArea& area) {
  const Eigen::Vector3d eye = Eigen::Vector3d(1.15, -1.5, 0.8).normalized();
  View view;
  view.right = Eigen::Vector3d::UnitZ().cross(eye).normalized();
  view.up = eye.cross(view.right);
  view.low.setConstant(HUGE_VAL);
  view.high.setConstant(-HUGE_VAL);
  for (const auto& t : figure.traces) {
    for (std::size_t i = 0; i < t.z.size(); ++i) {
      const Eigen::Vector3d p(t.x[i], t.y[i], t.z[i]);
      if (!p.allFinite()) continue;
      view.low = view.low.cwiseMin(p);
      view.high = view.high.cwiseMax(p);
    }
  }
  if (!view.low.allFinite()) {
    view.low.setZero();
    view.high.setOnes();
  }
  const Eigen::Vector3d middle = 0.5 * (view.low + view.high);
  const double longest = std::max((view.high - view.low).maxCoeff(), 1e-12);
  const Eigen::Vector3d half = 0.54 * (view.high - view.low).cwiseMax(0.25 * longest);
  view.low = middle - half;
  view.high = middle + half;
  const double wide = 2.0 * view.right.cwiseAbs().dot(half),
               tall = 2.0 * view.up.cwiseAbs().dot(half);
  view.px_per_unit = std::min(area.width / (1.3 * wide), area.height / (1.15 * tall));
  view.middle = {area.left + 0.5 * area.width, area.top + 0.5 * area.height};
  return view;
}

/// Draws one edge of the box with ticks and the axis' label; `corner` holds the other two
/// coordinates.
void DrawEdge(const View& view, int axis, Eigen::Vector3d corner, const std::string& label,
              Place outward, Canvas& canvas) {
  const TextStyle style{.size = 11.0, .align_x = 0.5 - 0.5 * outward.x, .align_y = 0.5};
  const Axis scale(view.low[axis], view.high[axis]);
  const auto at = [&](double value) {
    corner[axis] = value;
    return view.At(corner);
  };
  canvas.Line({at(view.low[axis]), at(view.high[axis])}, "#9aa5b1", 1.0);
  for (const Tick& tick : scale.Ticks(4)) {
    const Place p = at(tick.value);
    canvas.Line({p, {p.x + 5.0 * outward.x, p.y + 5.0 * outward.y}}, "#9aa5b1", 1.0);
    canvas.Text(tick.text, {p.x + 10.0 * outward.x, p.y + 12.0 * outward.y}, style);
  }
  const Place middle = at(0.5 * (view.low[axis] + view.high[axis]));
  canvas.Text(label, {middle.x + 46.0 * outward.x, middle.y + 34.0 * outward.y}, style);
}

}  // namespace

void DrawSpace(const Figure& figure, const PlotArea& area, Canvas& canvas) {
  const View view = Fit(figure, area);
  const Eigen::Vector3d low = view.low, high = view.high;
  // The edges nearest to the viewer at the bottom, and the left one upward.
  DrawEdge(view, 0, {0.0, low.y(), low.z()}, figure.x_label, {-0.6, 1.0}, canvas);
  DrawEdge(view, 1, {high.x(), 0.0, low.z()}, figure.y_label, {0.6, 1.0}, canvas);
  DrawEdge(view, 2, {low.x(), low.y(), 0.0}, figure.z_label, {-1.0, 0.0}, canvas);
  for (std::size_t i = 0; i < figure.traces.size(); ++i) {
    const auto& t = figure.traces[i];
    const std::string color = TraceColor(t, i);
    std::vector<Place> stretch;
    const auto end_stretch = [&] {
      canvas.Line(stretch, color, 2.5, t.dashed);
      stretch.clear();
    };
    for (std::size_t k = 0; k < t.z.size(); ++k) {
      const Eigen::Vector3d p(t.x[k], t.y[k], t.z[k]);
      if (!p.allFinite()) {
        end_stretch();
      } else if (t.kind == FigureTrace::Kind::kPoints) {
        canvas.Disc(view.At(p), 2.5, color);
      } else {
        stretch.push_back(view.At(p));
      }
    }
    end_stretch();
  }
}

}  // namespace flextip::report
