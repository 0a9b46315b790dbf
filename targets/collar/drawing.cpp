#include "targets/collar/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "report/drawing/canvas.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

using Eigen::Vector2d;
using report::Canvas;
using report::Place;

constexpr double kWidth_px = 900.0, kHeight_px = 430.0, kMiddle_px = 205.0;
constexpr const char* kInk = "#1d2733";
constexpr const char* kDimension = "#0072b2";
constexpr const char* kShaft = "#c9d1d9";
constexpr const char* kMount = "#eef1f4";
constexpr const char* kPaper = "#ffffff";

/// A view: metres to px about an origin.
struct View {
  Place origin;
  double px_per_m;

  Place At(double x_m, double y_m) const {
    return {origin.x + px_per_m * x_m, origin.y + px_per_m * y_m};
  }
};

void Outline(Canvas& canvas, std::vector<Place> corners, const std::string& fill,
             double width = 1.2) {
  canvas.Fill(corners, fill);
  corners.push_back(corners.front());
  canvas.Line(corners, kInk, width);
}

void Arrow(Canvas& canvas, Place tip, Place from) {
  const double length = std::hypot(tip.x - from.x, tip.y - from.y);
  const double ux = (tip.x - from.x) / length, uy = (tip.y - from.y) / length;
  canvas.Fill({tip,
               {tip.x - 8.0 * ux + 2.6 * uy, tip.y - 8.0 * uy - 2.6 * ux},
               {tip.x - 8.0 * ux - 2.6 * uy, tip.y - 8.0 * uy + 2.6 * ux}},
              kDimension);
}

/// A dimension between two places along x at the height `y`, with lines up or down from `edge_y`.
void AlongX(Canvas& canvas, double x0, double x1, double edge_y, double y,
            const std::string& text) {
  for (const double x : {x0, x1}) {
    canvas.Line({{x, edge_y}, {x, y + (y > edge_y ? 5.0 : -5.0)}}, kDimension, 0.8);
  }
  canvas.Line({{x0, y}, {x1, y}}, kDimension, 0.8);
  Arrow(canvas, {x0, y}, {x1, y});
  Arrow(canvas, {x1, y}, {x0, y});
  const bool inside = canvas.Width(text) < std::abs(x1 - x0) - 4.0;
  const Place at =
      inside ? Place{0.5 * (x0 + x1), y - 5.0} : Place{std::max(x0, x1) + 8.0, y + 4.0};
  canvas.Text(text, at, {.align_x = inside ? 0.5 : 0.0, .color = kDimension});
}

/// The same along y at `x`.
void AlongY(Canvas& canvas, double y0, double y1, double edge_x, double x,
            const std::string& text) {
  for (const double y : {y0, y1}) {
    canvas.Line({{edge_x, y}, {x + (x > edge_x ? 5.0 : -5.0), y}}, kDimension, 0.8);
  }
  canvas.Line({{x, y0}, {x, y1}}, kDimension, 0.8);
  Arrow(canvas, {x, y0}, {x, y1});
  Arrow(canvas, {x, y1}, {x, y0});
  canvas.Text(text, {x - 5.0, 0.5 * (y0 + y1)},
              {.align_x = 0.5, .upward = true, .color = kDimension});
}

std::string Mm(double m, const std::string& before = "") {
  return fmt::format("{}{:.4g} mm", before, std::round(1e5 * m) / 100.0);
}

/// The tag that faces the reader, drawn where it is.
void DrawTag(const CollarDesign& d, const View& view, Canvas& canvas) {
  const TagCells tag = ReadTagCells(d.collar.family, d.collar.tags.front().id);
  const double left = -d.wishes.from_tip_m - 0.5 * d.plate_m, top = -0.5 * d.plate_m;
  std::vector<std::pair<Place, Place>> black;
  for (int row = 0; row < tag.cells; ++row) {
    for (int column = 0; column < tag.cells; ++column) {
      if (tag.At(column, row) != TagCells::kBlack) continue;
      black.emplace_back(view.At(left + d.cell_m * column, top + d.cell_m * row),
                         view.At(left + d.cell_m * (column + 1), top + d.cell_m * (row + 1)));
    }
  }
  canvas.FillTogether(black, kInk);
}

/// The heights of the edges that are seen from the side, one face toward the reader, with the
/// outline's; from above to below.
std::vector<double> EdgeHeights(const CollarDesign& d) {
  const double half = std::numbers::pi / d.wishes.faces, radius = 0.5 * d.outer_m;
  std::vector<double> heights;
  double highest = 0.0;
  for (int i = 0; i < d.wishes.faces; ++i) {
    const double angle = half * (2 * i + 1);  // from the line of sight
    if (std::cos(angle) > 1e-9) heights.push_back(radius * std::sin(angle));
    highest = std::max(highest, radius * std::sin(angle));
  }
  heights.push_back(highest);
  heights.push_back(-highest);
  std::sort(heights.begin(), heights.end());
  return heights;
}

void DrawSide(const CollarDesign& d, const View& view, Canvas& canvas) {
  const double radius = 0.5 * d.wishes.shaft_diameter_m, x = -d.wishes.from_tip_m;
  const double from = x - 0.5 * d.length_m - 0.012, half = 0.5 * d.length_m;
  Outline(canvas,
          {view.At(from, -radius), view.At(0, -radius), view.At(0, radius), view.At(from, radius)},
          kShaft);
  const auto edges = EdgeHeights(d);
  const double top = edges.front(), bottom = edges.back();
  Outline(canvas,
          {view.At(x - half, top), view.At(x + half, top), view.At(x + half, bottom),
           view.At(x - half, bottom)},
          kPaper);
  for (const double y : edges) {
    canvas.Line({view.At(x - half, y), view.At(x + half, y)}, kInk, 0.8);
  }
  DrawTag(d, view, canvas);
  const double above = view.At(0, top).y, below = view.At(0, bottom).y;
  AlongX(canvas, view.At(x, 0).x, view.At(0, 0).x, view.At(0, radius).y, below + 34.0,
         Mm(d.wishes.from_tip_m));
  AlongX(canvas, view.At(x - half, 0).x, view.At(x + half, 0).x, above, above - 58.0,
         Mm(d.length_m));
  AlongX(canvas, view.At(x - 0.5 * d.tag_size_m, 0).x, view.At(x + 0.5 * d.tag_size_m, 0).x, above,
         above - 24.0, Mm(d.tag_size_m));
  AlongY(canvas, view.At(0, -radius).y, view.At(0, radius).y, view.At(0, 0).x,
         view.At(0, 0).x + 34.0, Mm(d.wishes.shaft_diameter_m, "⌀"));
  canvas.Text("E", {view.At(0, 0).x - 16.0, view.At(0, 0).y + 5.0}, {.size = 14.0, .bold = true});
  canvas.Disc(view.At(0, 0), 3.0, kDimension);
}

std::vector<Place> Polygon(const View& view, int count, double radius_m, double first) {
  std::vector<Place> corners;
  for (int i = 0; i < count; ++i) {
    const double angle = first + 2.0 * std::numbers::pi * i / count;
    corners.push_back(view.At(radius_m * std::cos(angle), radius_m * std::sin(angle)));
  }
  return corners;
}

void DrawEnd(const CollarDesign& d, const View& view, Canvas& canvas) {
  const double half = std::numbers::pi / d.wishes.faces, cosine = std::cos(half);
  const double first = -0.5 * std::numbers::pi + half;  // a face on top
  Outline(canvas, Polygon(view, d.wishes.faces, 0.5 * d.outer_m, first), kPaper);
  Outline(canvas, Polygon(view, d.wishes.faces, 0.5 * d.across_m / cosine, first), kMount, 0.8);
  Outline(canvas, Polygon(view, 72, 0.5 * d.bore_m, 0.0), kPaper);
  Outline(canvas, Polygon(view, 72, 0.5 * d.wishes.shaft_diameter_m, 0.0), kShaft, 0.8);
  const double radius = 0.5 * d.outer_m, top = -radius * cosine;
  const double lowest = radius * (d.wishes.faces % 2 == 0 ? cosine : 1.0);
  AlongX(canvas, view.At(-0.5 * d.face_m, 0).x, view.At(0.5 * d.face_m, 0).x, view.At(0, top).y,
         view.At(0, top).y - 24.0, Mm(d.face_m));
  AlongY(canvas, view.At(0, top).y, view.At(0, 0).y, view.At(-0.5 * d.face_m, 0).x,
         view.At(-radius, 0).x - 24.0, Mm(0.5 * d.across_m + d.wishes.paper_m));
  AlongX(canvas, view.At(-0.5 * d.bore_m, 0).x, view.At(0.5 * d.bore_m, 0).x, view.At(0, 0).y,
         view.At(0, lowest).y + 34.0, Mm(d.bore_m, "⌀"));
  canvas.Text(fmt::format("passes a port of {}", Mm(std::ceil(1e5 * d.outer_m) / 1e5, "⌀")),
              {view.origin.x, view.At(0, lowest).y + 62.0}, {.align_x = 0.5});
}

}  // namespace

void DrawCollar(const CollarDesign& d, const std::filesystem::path& file) {
  Canvas canvas(file, kWidth_px, kHeight_px);
  const double side_m = d.wishes.from_tip_m + 0.5 * d.length_m + 0.012;
  const double px_per_m = std::min({540.0 / side_m, 190.0 / d.outer_m});
  const View side{{40.0 + px_per_m * side_m, kMiddle_px}, px_per_m};
  const View end{{kWidth_px - 150.0, kMiddle_px}, px_per_m};
  DrawSide(d, side, canvas);
  DrawEnd(d, end, canvas);
  canvas.Text(
      fmt::format("{} x {}, the size between the corners that are detected; the tags on the "
                  "paper's surface. E: the tip's frame.",
                  d.wishes.faces, d.collar.family),
      {40.0, kHeight_px - 22.0}, {.size = 12.0});
  canvas.Finish();
}

}  // namespace flextip
