#include "report/stops/figures.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace flextip::report {
namespace {

constexpr const char* kInk = "#1d2733";
constexpr const char* kGoes = "#2e9e5b";
constexpr const char* kLimited = "#e6c229";
constexpr const char* kHeld = "#e6932b";
constexpr const char* kOut = "#c0392b";
constexpr double kStrip_px = 16.0;
constexpr double kPathBefore_s = 1.5, kPathAfter_s = 0.5;  // of the path that is drawn

struct SensorLook {
  const char* name;
  const char* color;
};
/// In the order of kStopSensors.
constexpr SensorLook kLooks[] = {{"camera", "#d55e00"},      {"EM", "#0072b2"},
                                 {"port sensor", "#b0578d"}, {"strain", "#009e73"},
                                 {"load cell", "#b88700"},   {"wrist's turn", "#555f6b"}};

std::size_t IndexOf(const std::string& sensor) {
  const auto at = std::find(kStopSensors.begin(), kStopSensors.end(), sensor);
  return static_cast<std::size_t>(at - kStopSensors.begin());
}

Eigen::Vector3d At(const PlaceOverTime& place, std::size_t i) {
  return {place.p_mm[0][i], place.p_mm[1][i], place.p_mm[2][i]};
}

/// The place at a time, between its neighbours; NaN outside.
Eigen::Vector3d AtTime(const PlaceOverTime& place, double t_s) {
  const auto after = std::lower_bound(place.t_s.begin(), place.t_s.end(), t_s);
  if (after == place.t_s.end()) return Eigen::Vector3d::Constant(std::nan(""));
  const auto i = static_cast<std::size_t>(after - place.t_s.begin());
  if (*after == t_s || i == 0)
    return i == 0 && *after != t_s ? Eigen::Vector3d::Constant(std::nan("")) : At(place, i);
  const double u = (t_s - place.t_s[i - 1]) / (place.t_s[i] - place.t_s[i - 1]);
  return (1.0 - u) * At(place, i - 1) + u * At(place, i);
}

std::vector<FigureBand> Bands(const StopMarks& marks, double last_s) {
  std::vector<FigureBand> bands;
  const double end_s = std::min(marks.end_s, last_s);
  const double held_to_s = marks.fault_s > 0.0 ? marks.fault_s : end_s;
  if (held_to_s > marks.at_s) bands.push_back({marks.at_s, held_to_s, kHeld});
  if (marks.fault_s > 0.0 && end_s > marks.fault_s) bands.push_back({marks.fault_s, end_s, kOut});
  bands.push_back({marks.at_s, marks.at_s, kOut});
  return bands;
}

std::string BandWords(const StopMarks& marks) {
  return marks.fault_s > 0.0
             ? "Dashed: the moment of the stop. Orange: held. Red: paused until a person goes on."
             : "Dashed: the moment of the stop. Orange: held.";
}

std::string OthersWords(const StopMarks& marks) {
  const std::size_t odd = IndexOf(marks.odd);
  if (odd >= kStopSensors.size()) return "";
  return fmt::format("The others: all sensors but the {} together. ", kLooks[odd].name);
}

/// The tips of the sensors from the others' tip; where no sensor is odd, from the controller's.
Figure Distances(const StopRows& rows, const StopMarks& marks) {
  const bool has_rest = !rows.rest.Empty();
  const PlaceOverTime& from = has_rest ? rows.rest : rows.used;
  const std::size_t odd = IndexOf(marks.odd);
  Figure figure{.name = marks.name + "-distance",
                .title = has_rest ? "How far each sensor's tip is from the others'"
                                  : "How far each sensor's tip is from the controller's",
                .caption = OthersWords(marks) + BandWords(marks),
                .x_label = "time (s)",
                .y_label = "distance (mm)",
                .bands = Bands(marks, rows.t_s.back())};
  for (std::size_t s = 0; s < kStopSensors.size(); ++s) {
    const PlaceOverTime& place = rows.by[s];
    FigureTrace trace{.name = kLooks[s].name, .color = kLooks[s].color};
    for (std::size_t i = 0; i < place.t_s.size(); ++i) {
      const double mm = (At(place, i) - AtTime(from, place.t_s[i])).norm();
      if (!std::isfinite(mm)) continue;
      trace.x.push_back(place.t_s[i]);
      trace.y.push_back(mm);
    }
    if (trace.x.empty()) continue;
    if (s == odd) trace.width = 4.0;
    figure.traces.push_back(std::move(trace));
  }
  return figure;
}

/// The two axes of R along which the tip went farthest; z is up where it is one of them.
class View {
 public:
  explicit View(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d low = points.front(), high = points.front();
    for (const Eigen::Vector3d& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    Eigen::Index least = 0;
    (high - low).minCoeff(&least);
    right_ = least == 0 ? 1 : 0;
    up_ = least == 2 ? 1 : 2;
  }
  double Right(const Eigen::Vector3d& p) const { return p[right_]; }
  double Up(const Eigen::Vector3d& p) const { return p[up_]; }
  std::string RightLabel() const { return Label(right_); }
  std::string UpLabel() const { return Label(up_); }

 private:
  static std::string Label(Eigen::Index axis) { return std::string(1, "xyz"[axis]) + " in R (mm)"; }
  Eigen::Index right_ = 0, up_ = 2;
};

Figure Path(const StopRows& rows, const StopMarks& marks) {
  const auto drawn = [&](double t_s) {
    return t_s >= marks.at_s - kPathBefore_s && t_s <= marks.at_s + kPathAfter_s;
  };
  const auto each = [&](const PlaceOverTime& place, const std::function<void(std::size_t)>& act) {
    for (std::size_t i = 0; i < place.t_s.size(); ++i)
      if (drawn(place.t_s[i])) act(i);
  };
  std::vector<Eigen::Vector3d> points;
  const auto collect = [&](const PlaceOverTime& place) {
    each(place, [&](std::size_t i) { points.push_back(At(place, i)); });
  };
  collect(rows.wanted);
  collect(rows.rest);
  for (const PlaceOverTime& by : rows.by) collect(by);
  Figure figure{.name = marks.name + "-path",
                .title = "Where the tip was, by each sensor",
                .caption =
                    "From 1.5 s before the stop to 0.5 s after it, seen along an axis of R. "
                    "Dots: at the moment of the stop.",
                .equal_axes = true};
  if (points.empty()) return figure;
  const View view(points);
  figure.x_label = view.RightLabel();
  figure.y_label = view.UpLabel();
  const auto line = [&](const PlaceOverTime& place, const char* name, const char* color,
                        double width, bool dashed) {
    FigureTrace trace{.name = name, .color = color, .width = width, .dashed = dashed};
    each(place, [&](std::size_t i) {
      trace.x.push_back(view.Right(At(place, i)));
      trace.y.push_back(view.Up(At(place, i)));
    });
    if (!trace.x.empty()) figure.traces.push_back(std::move(trace));
  };
  const auto dot = [&](const PlaceOverTime& place, const char* color, const std::string& text) {
    const Eigen::Vector3d p = AtTime(place, marks.at_s);
    if (!p.allFinite()) return;
    figure.traces.push_back({.kind = FigureTrace::Kind::kPoints,
                             .x = {view.Right(p)},
                             .y = {view.Up(p)},
                             .texts = {text},
                             .color = color});
  };
  const std::size_t odd = IndexOf(marks.odd);
  for (std::size_t s = 0; s < kStopSensors.size(); ++s)
    line(rows.by[s], kLooks[s].name, kLooks[s].color, s == odd ? 4.0 : 1.5, false);
  line(rows.wanted, "wanted", kInk, 3.0, true);
  if (odd < kStopSensors.size()) {
    dot(rows.by[odd], kLooks[odd].color, kLooks[odd].name);
    dot(rows.rest, kInk, "the others");
  } else {
    dot(rows.used, kInk, "at the stop");
  }
  return figure;
}

Figure Ratio(const StopRows& rows, const StopMarks& marks) {
  Figure figure{.name = marks.name + "-chi2",
                .title = "Do the sensors agree? Chi-squared over its limit",
                .caption = "Above 1 they cannot all be right together. " + BandWords(marks),
                .x_label = "time (s)",
                .y_label = "chi-squared / limit",
                .log_y = true,
                .bands = Bands(marks, rows.t_s.back())};
  FigureTrace ratio{.name = "all sensors together", .color = "#0072b2"};
  for (std::size_t i = 0; i < rows.ratio.size(); ++i) {
    const bool drawable = rows.ratio[i] > 0.0 && std::isfinite(rows.ratio[i]);
    if (!drawable) continue;
    ratio.x.push_back(rows.t_s[i]);
    ratio.y.push_back(rows.ratio[i]);
  }
  if (ratio.x.empty()) return figure;
  figure.traces.push_back(std::move(ratio));
  figure.traces.push_back({.name = "limit",
                           .x = {rows.t_s.front(), rows.t_s.back()},
                           .y = {1.0, 1.0},
                           .color = kOut,
                           .dashed = true});
  return figure;
}

/// Adds the stretches of row `y` in which `is(i)`.
void AddStrip(const StopRows& rows, double y, const std::function<bool(std::size_t)>& is,
              FigureTrace& trace) {
  const std::size_t count = rows.t_s.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!is(i)) continue;
    std::size_t end = i;
    while (end + 1 < count && is(end + 1)) ++end;
    // Until the next row begins.
    const double to_s = end + 1 < count ? rows.t_s[end + 1] : rows.t_s[end];
    trace.x.insert(trace.x.end(), {rows.t_s[i], to_s, std::nan("")});
    trace.y.insert(trace.y.end(), {y, y, std::nan("")});
    i = end;
  }
}

Figure Strips(const StopRows& rows, const StopMarks& marks) {
  Figure figure{.name = marks.name + "-strips",
                .title = "Which sensors were used, and what the robot did",
                .caption = "A gap: the sensor had nothing to say.",
                .x_label = "time (s)",
                .y_down = true};
  const auto trace = [](const char* name, const char* color) {
    FigureTrace strip{.name = name, .color = color};
    strip.width = kStrip_px;
    return strip;
  };
  FigureTrace used = trace("used, goes on", kGoes), out = trace("left out", kOut);
  FigureTrace limited = trace("command limited", kLimited), held = trace("held", kHeld);
  FigureTrace paused = trace("paused", "#7b1e1e");
  for (std::size_t s = 0; s < kStopSensors.size(); ++s) {
    const auto there = [&](std::size_t i) { return (rows.there[i] >> s & 1) != 0; };
    const auto is_out = [&](std::size_t i) { return (rows.out[i] >> s & 1) != 0; };
    bool ever = false;
    for (std::size_t i = 0; i < rows.t_s.size(); ++i) ever |= there(i);
    if (!ever) continue;
    const auto y = static_cast<double>(figure.y_names.size());
    figure.y_names.emplace_back(kLooks[s].name);
    AddStrip(
        rows, y, [&](std::size_t i) { return there(i) && !is_out(i); }, used);
    AddStrip(rows, y, is_out, out);
  }
  const auto y = static_cast<double>(figure.y_names.size());
  figure.y_names.emplace_back("robot");
  FigureTrace* const of_reaction[] = {&used, &limited, &held, &paused};
  for (int r = 0; r < 4; ++r)
    AddStrip(
        rows, y, [&](std::size_t i) { return rows.reaction[i] == r; }, *of_reaction[r]);
  for (FigureTrace* strip : {&used, &out, &limited, &held, &paused})
    if (!strip->x.empty()) figure.traces.push_back(std::move(*strip));
  figure.bands.push_back({marks.at_s, marks.at_s, kOut});
  return figure;
}

}  // namespace

std::vector<Figure> StopFigures(const StopRows& rows, const StopMarks& marks) {
  if (rows.t_s.empty()) return {};
  std::vector<Figure> figures;
  for (Figure& figure : std::vector<Figure>{Distances(rows, marks), Path(rows, marks),
                                            Ratio(rows, marks), Strips(rows, marks)})
    if (!figure.traces.empty()) figures.push_back(std::move(figure));
  return figures;
}

}  // namespace flextip::report
