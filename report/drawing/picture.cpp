#include "report/drawing/picture.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/drawing/plot.h"
#include "report/drawing/space.h"

namespace flextip::report {
namespace {

constexpr double kWidth_px = 900.0, kPlotHeight_px = 400.0;
constexpr double kLeft_px = 74.0, kRight_px = 30.0, kTitle_px = 40.0, kLegendRow_px = 22.0;
constexpr double kBelow_px = 56.0, kScaleRoom_px = 90.0, kBarRow_px = 26.0;
constexpr const char* kGrid = "#e3e8ed";
constexpr const char* kFrame = "#9aa5b1";

/// The least and largest of some numbers.
struct Span {
  double low = HUGE_VAL, high = -HUGE_VAL;

  void Add(double v, bool log) {
    if (!std::isfinite(v) || (log && v <= 0.0)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  Axis AsAxis(bool log, double margin) const {
    if (!(high > low)) return {low, high, log};
    if (log) return {low / std::pow(high / low, margin), high * std::pow(high / low, margin), true};
    return {low - margin * (high - low), high + margin * (high - low), false};
  }
};

bool HasBars(const Figure& figure) {
  return std::any_of(figure.traces.begin(), figure.traces.end(),
                     [](const FigureTrace& t) { return t.kind == FigureTrace::Kind::kBars; });
}

const std::vector<std::string>* Categories(const Figure& figure) {
  for (const auto& t : figure.traces) {
    if (!t.labels.empty()) return &t.labels;
  }
  return nullptr;
}

/// Fits both axes to all that is drawn. Bars reach to zero; categories lie at 0, 1, 2...
void FitAxes(const Figure& figure, PlotArea& area) {
  Span x, y;
  for (const auto& field : figure.fields) {
    for (const double v : field.x) x.Add(v, figure.log_x);
    for (const double v : field.y) y.Add(v, figure.log_y);
  }
  for (const auto& t : figure.traces) {
    for (std::size_t i = 0; i < t.y.size(); ++i) {
      const double error = t.y_error.empty() ? 0.0 : t.y_error[i];
      if (t.labels.empty()) x.Add(t.x[i], figure.log_x);
      y.Add(t.y[i] - error, figure.log_y);
      y.Add(t.y[i] + error, figure.log_y);
    }
  }
  if (HasBars(figure) && !figure.log_y) y.Add(0.0, false);
  for (const auto& band : figure.bands) {
    x.Add(band.from, figure.log_x);
    x.Add(band.to, figure.log_x);
  }
  const double margin = figure.fields.empty() ? 0.04 : 0.0;
  area.x = x.AsAxis(figure.log_x, margin);
  area.y = y.AsAxis(figure.log_y, figure.fields.empty() ? 0.06 : 0.0);
  if (const auto* labels = Categories(figure)) {
    area.x = Axis(-0.5, static_cast<double>(labels->size()) - 0.5);
  }
  area.y_down = figure.y_down;
  if (!figure.y_names.empty())
    area.y = Axis(-0.6, static_cast<double>(figure.y_names.size()) - 0.4);
  if (figure.lying_bars) {
    area.y = Axis(std::min(0.0, y.low), y.high > 0.0 ? 1.1 * y.high : 1.0);
    std::swap(area.x, area.y);
    area.y_down = true;
  }
}

/// Makes a length as long in both directions, by widening one axis; a flat drawing takes less
/// height.
void EqualiseAxes(PlotArea& area) {
  const double x_span = area.x.High() - area.x.Low(), y_span = area.y.High() - area.y.Low();
  const double needed_px = area.width * y_span / x_span;
  area.height = std::clamp(1.15 * needed_px, 90.0, area.height);
  if (needed_px <= area.height) {
    area.y.Widen(area.height / needed_px);
  } else {
    area.x.Widen(needed_px / area.height);
  }
}

/// Writes ticks, grid and labels of the axes.
void DrawAxes(const Figure& figure, const PlotArea& area, Canvas& canvas) {
  const double right = area.left + area.width, bottom = area.top + area.height;
  const auto* labels = Categories(figure);
  std::vector<Tick> names;
  for (std::size_t i = 0; labels && i < labels->size(); ++i) {
    names.push_back({static_cast<double>(i), (*labels)[i]});
  }
  const bool below = labels && !figure.lying_bars, beside = labels && figure.lying_bars;
  for (const Tick& tick : below ? names : area.x.Ticks(8)) {
    const double x = area.left + area.width * area.x.Share(tick.value);
    if (!below) canvas.Line({{x, area.top}, {x, bottom}}, kGrid, 1.0);
    canvas.Text(tick.text, {x, bottom + 8.0}, {.size = 12.0, .align_x = 0.5, .align_y = 0.0});
  }
  std::vector<Tick> rows;
  for (std::size_t i = 0; i < figure.y_names.size(); ++i)
    rows.push_back({static_cast<double>(i), figure.y_names[i]});
  for (const Tick& tick : beside ? names : !rows.empty() ? rows : area.y.Ticks(6)) {
    const double y = area.At(area.x.Low(), tick.value).y;
    if (!beside && rows.empty()) canvas.Line({{area.left, y}, {right, y}}, kGrid, 1.0);
    canvas.Text(tick.text, {area.left - 7.0, y}, {.size = 12.0, .align_x = 1.0, .align_y = 0.5});
  }
  canvas.Line({{area.left, area.top}, {area.left, bottom}, {right, bottom}}, kFrame, 1.0);
  canvas.Text(figure.lying_bars ? figure.y_label : figure.x_label,
              {area.left + 0.5 * area.width, bottom + 30.0}, {.align_x = 0.5, .align_y = 0.0});
  if (!figure.lying_bars) {
    canvas.Text(figure.y_label, {18.0, area.top + 0.5 * area.height},
                {.align_x = 0.5, .align_y = 0.5, .upward = true});
  }
}

void DrawBands(const Figure& figure, const PlotArea& area, Canvas& canvas) {
  for (const auto& band : figure.bands) {
    const double a = area.left + area.width * area.x.Share(band.from);
    const double b = area.left + area.width * area.x.Share(band.to);
    const double bottom = area.top + area.height;
    if (band.from == band.to) {
      canvas.Line({{a, area.top}, {a, bottom}}, band.color, 2.0, true);
    } else {
      canvas.Fill({{a, area.top}, {b, area.top}, {b, bottom}, {a, bottom}}, band.color, 0.18);
    }
  }
}

void DrawColorScale(const FigureField& field, const PlotArea& area, Canvas& canvas) {
  constexpr int kSteps = 60;
  const double left = area.left + area.width + 14.0, step = area.height / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double y = area.top + area.height - step * (i + 1);
    canvas.Fill({{left, y}, {left + 12.0, y}, {left + 12.0, y + step}, {left, y + step}},
                FieldColor((i + 0.5) / kSteps));
  }
  const auto [low, high] = FieldRange(field);
  const Axis scale(low, high);
  for (const Tick& tick : scale.Ticks(5)) {
    canvas.Text(tick.text, {left + 16.0, area.top + area.height * (1.0 - scale.Share(tick.value))},
                {.size = 11.0, .align_y = 0.5});
  }
  canvas.Text(field.name, {left + 66.0, area.top + 0.5 * area.height},
              {.size = 12.0, .align_x = 0.5, .align_y = 0.5, .upward = true});
}

/// Writes the names of the traces into rows below `top`; with no canvas to draw on, only counts.
/// Returns the number of rows.
int DrawLegend(const Figure& figure, double top, Canvas* canvas) {
  if (figure.traces.size() + figure.fields.size() < 2) return 0;
  int rows = 0;
  double x = kWidth_px;
  for (std::size_t i = 0; i < figure.traces.size(); ++i) {
    const auto& t = figure.traces[i];
    if (t.name.empty()) continue;
    const double width = 40.0 + 7.6 * static_cast<double>(t.name.size());
    if (x + width > kWidth_px - kRight_px) {
      x = kLeft_px;
      ++rows;
    }
    if (canvas != nullptr) {
      const double y = top + kLegendRow_px * (rows - 0.5);
      const std::string color = TraceColor(t, i);
      if (t.kind == FigureTrace::Kind::kLine) {
        canvas->Line({{x, y}, {x + 22.0, y}}, color, 2.5, t.dashed);
      } else {
        canvas->Disc({x + 11.0, y}, 5.0, color);
      }
      canvas->Text(t.name, {x + 28.0, y}, {.size = 12.0, .align_y = 0.5});
    }
    x += width;
  }
  return rows;
}

PlotArea AreaOf(const Figure& figure) {
  const double scale_room = figure.fields.empty() ? 0.0 : kScaleRoom_px;
  PlotArea area{.left = kLeft_px,
                .top = kTitle_px + kLegendRow_px * DrawLegend(figure, 0.0, nullptr) + 6.0,
                .width = kWidth_px - kLeft_px - kRight_px - scale_room,
                .height = kPlotHeight_px};
  if (figure.InSpace()) return area;
  FitAxes(figure, area);
  if (figure.lying_bars) {
    std::size_t bars = 0, longest = 0;
    for (const auto& t : figure.traces) bars += t.y.size();
    if (const auto* labels = Categories(figure)) {
      for (const auto& label : *labels) longest = std::max(longest, label.size());
    }
    const double names = std::clamp(7.2 * static_cast<double>(longest), 0.0, 300.0);
    area.left += names;
    area.width -= names + 50.0;
    area.height = 20.0 + kBarRow_px * static_cast<double>(bars);
  }
  if (!figure.y_names.empty()) {
    area.left += 40.0;
    area.width -= 40.0;
    area.height = 20.0 + kBarRow_px * static_cast<double>(figure.y_names.size());
  }
  if (figure.equal_axes) EqualiseAxes(area);
  return area;
}

double HeightOf(const PlotArea& area) { return area.top + area.height + kBelow_px; }

void Draw(const Figure& figure, double offset, Canvas& canvas) {
  PlotArea area = AreaOf(figure);
  area.top += offset;
  canvas.Text(figure.title, {kLeft_px, offset + 26.0}, {.size = 16.0, .bold = true});
  DrawLegend(figure, offset + kTitle_px, &canvas);
  if (figure.InSpace()) {
    DrawSpace(figure, area, canvas);
    return;
  }
  DrawAxes(figure, area, canvas);
  canvas.Clip({area.left, area.top - 6.0}, area.width + 60.0, area.height + 6.0);
  DrawBands(figure, area, canvas);
  for (const auto& field : figure.fields) DrawField(field, area, canvas);
  const auto bars = static_cast<std::size_t>(
      std::count_if(figure.traces.begin(), figure.traces.end(),
                    [](const auto& t) { return t.kind == FigureTrace::Kind::kBars; }));
  std::size_t bar = 0;
  for (std::size_t i = 0; i < figure.traces.size(); ++i) {
    const auto& trace = figure.traces[i];
    if (trace.kind == FigureTrace::Kind::kBars) {
      DrawBars(trace, TraceColor(trace, i), bar++, bars, figure.lying_bars, area, canvas);
    } else {
      DrawTrace(trace, TraceColor(trace, i), area, canvas);
    }
  }
  canvas.Unclip();
  for (const auto& field : figure.fields) DrawColorScale(field, area, canvas);
}

}  // namespace

void WritePicture(const std::filesystem::path& file, const std::vector<Figure>& figures,
                  std::size_t columns) {
  std::vector<double> rows;  // their heights
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (i % columns == 0) rows.push_back(0.0);
    rows.back() = std::max(rows.back(), HeightOf(AreaOf(figures[i])));
  }
  const double height = std::accumulate(rows.begin(), rows.end(), 0.0);
  const std::size_t across = std::clamp<std::size_t>(figures.size(), 1, columns);
  Canvas canvas(file, kWidth_px * static_cast<double>(across), std::max(height, 1.0));
  double offset = 0.0;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    Draw(figures[i], offset, canvas);
    if ((i + 1) % columns != 0) {
      canvas.Shift(kWidth_px, 0.0);
      continue;
    }
    canvas.Shift(-kWidth_px * static_cast<double>(columns - 1), 0.0);
    offset += rows[i / columns];
  }
  canvas.Finish();
}

}  // namespace flextip::report
