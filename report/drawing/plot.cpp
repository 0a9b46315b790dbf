#include "report/drawing/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace flextip::report {
namespace {

constexpr const char* kInk = "#1d2733";
constexpr std::array kColors{"#0072b2", "#d55e00", "#009e73", "#b0578d",
                             "#b88700", "#3a9bd6", "#555f6b"};

bool Drawable(const Place& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

/// Draws the stretches between gaps.
void DrawCurve(const std::vector<Place>& places, const std::string& color, double width,
               bool dashed, Canvas& canvas) {
  std::vector<Place> stretch;
  for (const Place& p : places) {
    if (Drawable(p)) {
      stretch.push_back(p);
      continue;
    }
    canvas.Line(stretch, color, width, dashed);
    stretch.clear();
  }
  canvas.Line(stretch, color, width, dashed);
}

void DrawArrowHead(const Place& from, const Place& to, const std::string& color, Canvas& canvas) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  if (!(length > 0.0)) return;
  const double u = (to.x - from.x) / length, v = (to.y - from.y) / length;
  constexpr double kHead = 12.0, kHalf = 5.0;
  canvas.Fill({to,
               {to.x - kHead * u - kHalf * v, to.y - kHead * v + kHalf * u},
               {to.x - kHead * u + kHalf * v, to.y - kHead * v - kHalf * u}},
              color);
}

void DrawPoint(const Place& p, const std::string& symbol, double radius, const std::string& color,
               Canvas& canvas) {
  const double r = radius;
  if (symbol.starts_with("x") || symbol.starts_with("cross")) {
    canvas.Line({{p.x - r, p.y - r}, {p.x + r, p.y + r}}, color, 2.0);
    canvas.Line({{p.x - r, p.y + r}, {p.x + r, p.y - r}}, color, 2.0);
  } else if (symbol.starts_with("diamond") || symbol.starts_with("square")) {
    canvas.Fill({{p.x - r, p.y}, {p.x, p.y - r}, {p.x + r, p.y}, {p.x, p.y + r}}, color);
  } else {
    canvas.Disc(p, r, color, !symbol.ends_with("open"));
  }
}

/// Returns the corners between neighbouring grid lines around grid line `i`.
std::pair<double, double> CellSides(const std::vector<double>& grid, std::size_t i) {
  if (grid.size() < 2) return {grid[i] - 0.5, grid[i] + 0.5};
  const double before = i > 0 ? grid[i - 1] : 2.0 * grid[0] - grid[1];
  const double after = i + 1 < grid.size() ? grid[i + 1] : 2.0 * grid[i] - grid[i - 1];
  return {0.5 * (before + grid[i]), 0.5 * (grid[i] + after)};
}

/// Draws the line where the field has the value `level`: where it crosses a cell's sides, by linear
/// interpolation (marching squares; a saddle is drawn one of its two ways).
void DrawContour(const FigureField& field, double level, const PlotArea& area, Canvas& canvas) {
  const std::size_t columns = field.x.size();
  for (std::size_t r = 0; r + 1 < field.y.size(); ++r) {
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      constexpr std::array<std::array<std::size_t, 2>, 5> kCorners{
          {{0, 0}, {0, 1}, {1, 1}, {1, 0}, {0, 0}}};
      std::vector<Place> crossings;
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [r0, c0] = kCorners[k];
        const auto [r1, c1] = kCorners[k + 1];
        const double a = field.values[(r + r0) * columns + c + c0] - level;
        const double b = field.values[(r + r1) * columns + c + c1] - level;
        if (!(std::isfinite(a) && std::isfinite(b)) || (a < 0.0) == (b < 0.0)) continue;
        const double t = a / (a - b);
        crossings.push_back(area.At(std::lerp(field.x[c + c0], field.x[c + c1], t),
                                    std::lerp(field.y[r + r0], field.y[r + r1], t)));
      }
      for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
        canvas.Line({crossings[k], crossings[k + 1]}, kInk, 1.2);
      }
    }
  }
}

}  // namespace

Place PlotArea::At(double x_value, double y_value) const {
  const double up = y.Share(y_value);
  return {left + width * x.Share(x_value), top + height * (y_down ? up : 1.0 - up)};
}

std::string TraceColor(const FigureTrace& trace, std::size_t i) {
  return trace.color.empty() ? kColors[i % kColors.size()] : trace.color;
}

std::string FieldColor(double share) {
  constexpr std::array<std::array<double, 3>, 5> kScale{{{0xf7, 0xfb, 0xff},
                                                         {0xcf, 0xe1, 0xf2},
                                                         {0x93, 0xc4, 0xde},
                                                         {0x4a, 0x97, 0xc9},
                                                         {0x17, 0x63, 0xaa}}};
  const double at = 4.0 * std::clamp(share, 0.0, 1.0);
  const std::size_t i = std::min<std::size_t>(3, static_cast<std::size_t>(at));
  std::array<int, 3> rgb{};
  for (std::size_t k = 0; k < 3; ++k) {
    rgb[k] = static_cast<int>(
        std::lround(std::lerp(kScale[i][k], kScale[i + 1][k], at - static_cast<double>(i))));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

void DrawTrace(const FigureTrace& trace, const std::string& color, const PlotArea& area,
               Canvas& canvas) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < trace.y.size(); ++i) {
    places.push_back(
        area.At(trace.labels.empty() ? trace.x[i] : static_cast<double>(i), trace.y[i]));
  }
  for (std::size_t i = 0; i < trace.y_error.size(); ++i) {
    if (!Drawable(places[i]) || !std::isfinite(trace.y_error[i])) continue;
    const double x = trace.labels.empty() ? trace.x[i] : static_cast<double>(i);
    canvas.Line(
        {area.At(x, trace.y[i] - trace.y_error[i]), area.At(x, trace.y[i] + trace.y_error[i])},
        kInk, 1.2);
  }
  if (trace.kind == FigureTrace::Kind::kLine) {
    DrawCurve(places, color, trace.width > 0.0 ? trace.width : 2.0, trace.dashed, canvas);
    if (trace.arrow && places.size() > 1) {
      DrawArrowHead(places[places.size() - 2], places.back(), color, canvas);
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!Drawable(places[i])) continue;
    if (trace.kind == FigureTrace::Kind::kPoints) {
      DrawPoint(places[i], trace.symbol, places.size() > 200 ? 2.0 : 4.0, color, canvas);
    }
    if (!trace.texts.empty()) {
      canvas.Text(trace.texts[i], {places[i].x + 7.0, places[i].y - 7.0}, {.size = 12.0});
    }
  }
}

void DrawBars(const FigureTrace& trace, const std::string& color, std::size_t index,
              std::size_t count, bool lying, const PlotArea& area, Canvas& canvas) {
  const double thick = 0.8 / static_cast<double>(count);
  for (std::size_t i = 0; i < trace.y.size(); ++i) {
    if (!std::isfinite(trace.y[i])) continue;
    const double middle = trace.labels.empty() ? trace.x[i] : static_cast<double>(i);
    const double from = middle - 0.4 + thick * static_cast<double>(index), to = from + thick;
    const auto at = [&](double across, double along) {
      return lying ? area.At(along, across) : area.At(across, along);
    };
    const double foot =
        std::clamp(0.0, lying ? area.x.Low() : area.y.Low(), lying ? area.x.High() : area.y.High());
    canvas.Fill({at(from, foot), at(to, foot), at(to, trace.y[i]), at(from, trace.y[i])},
                trace.colors.empty() ? color : trace.colors[i]);
    if (trace.texts.empty()) continue;
    const Place end = at(0.5 * (from + to), trace.y[i]);
    if (lying) {
      canvas.Text(trace.texts[i], {end.x + 5.0, end.y}, {.size = 12.0, .align_y = 0.5});
    } else {
      canvas.Text(trace.texts[i], {end.x, end.y - 4.0}, {.size = 12.0, .align_x = 0.5});
    }
  }
}

std::pair<double, double> FieldRange(const FigureField& field) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double v : field.values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  return {std::isfinite(field.low) ? field.low : low,
          std::isfinite(field.high) ? field.high : high};
}

void DrawField(const FigureField& field, const PlotArea& area, Canvas& canvas) {
  const auto [low, high] = FieldRange(field);
  const Axis scale(low, high);
  for (std::size_t r = 0; r < field.y.size(); ++r) {
    for (std::size_t c = 0; c < field.x.size(); ++c) {
      const double value = field.values[r * field.x.size() + c];
      if (!std::isfinite(value)) continue;
      const auto [x0, x1] = CellSides(field.x, c);
      const auto [y0, y1] = CellSides(field.y, r);
      canvas.Fill({area.At(x0, y0), area.At(x1, y0), area.At(x1, y1), area.At(x0, y1)},
                  FieldColor(scale.Share(value)));
      if (field.cells) {
        canvas.Text(fmt::format("{:.4g}", value), area.At(field.x[c], field.y[r]),
                    {.size = 11.0, .align_x = 0.5, .align_y = 0.5});
      }
    }
  }
  for (const double level : field.levels) DrawContour(field, level, area, canvas);
}

}  // namespace flextip::report
