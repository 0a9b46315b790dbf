#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reproduction/chapter5/groups.h"
#include "reproduction/chapter5/rows.h"
#include "reproduction/chapter5/thesis.h"

namespace flextip::reproduction {
namespace {

/// The thesis's four, then ours.
const std::vector<std::pair<std::string, std::string>>& Colors() {
  static const std::vector<std::pair<std::string, std::string>> colors{
      {"Straight-Calculate", "#c23b3b"}, {"Flex-Calculate", "#e0912f"},
      {"Straight-Track", "#3b7dc2"},     {"Flex-Track", "#3b9d5d"},
      {"Rod-Calculate", "#8a6bbf"},      {"Rod-Track", "#222222"}};
  return colors;
}
std::string ColorOf(const std::string& name) {
  for (const auto& [of, color] : Colors()) {
    if (name.starts_with(of)) return color;
  }
  return "#888888";
}

using Value = double (*)(const OperatorResult&);

/// Means with standard errors; stars at the least and the largest, as in the thesis's figures.
report::Figure Bars(const std::vector<GroupResult>& results, Value value,
                    const ThesisNumbers* thesis) {
  report::Figure figure;
  report::FigureTrace ours{
      .name = "here", .kind = report::FigureTrace::Kind::kBars, .color = "#3b7dc2"};
  report::FigureTrace theirs{
      .name = "thesis", .kind = report::FigureTrace::Kind::kBars, .color = "#c9c9c9"};
  report::FigureTrace ends{.name = "least and largest here",
                           .kind = report::FigureTrace::Kind::kPoints,
                           .color = "#222222",
                           .symbol = "asterisk-open"};
  for (int i = 0; i < kThesisControllers; ++i) {
    theirs.labels.emplace_back(ThesisName(i));
    theirs.y.push_back(thesis[i].mean);
    theirs.y_error.push_back(thesis[i].sd / std::sqrt(10.0));
  }
  for (const char* name : {"Flex-Track", "Straight-Track", "Flex-Calculate", "Straight-Calculate",
                           "Rod-Calculate", "Rod-Track"}) {
    const GroupResult& group = Find(results, name);
    const MeanSd of = group.Of(value);
    ours.labels.emplace_back(name);
    ours.y.push_back(of.mean);
    ours.y_error.push_back(of.StandardError());
    std::vector<double> values;
    for (const auto& one : group.operators) values.push_back(value(one));
    const auto [least, largest] = std::minmax_element(values.begin(), values.end());
    for (const double end : {*least, *largest}) {
      ends.labels.emplace_back(name);
      ends.y.push_back(end);
    }
  }
  figure.traces = {theirs, ours, ends};
  return figure;
}

report::FigureTrace FirmerDepths(const std::vector<GroupResult>& results) {
  report::FigureTrace trace{.name = "here, silicone twice as strong",
                            .kind = report::FigureTrace::Kind::kBars,
                            .color = "#a8c8ea"};
  for (const char* name :
       {"Flex-Track", "Straight-Track", "Flex-Calculate", "Straight-Calculate", "Rod-Track"}) {
    const MeanSd of =
        Find(results, std::string(name) + " silicone x2").Of([](const OperatorResult& o) {
          return 1e3 * o.recorded.max_depth_m;
        });
    trace.labels.emplace_back(name);
    trace.y.push_back(of.mean);
    trace.y_error.push_back(of.StandardError());
  }
  return trace;
}

/// The operator whose depths are nearest the middle of all, over the four controllers.
int MedianOperator(const std::vector<GroupResult>& results) {
  const int count = static_cast<int>(results.front().operators.size());
  std::vector<double> off(count, 0.0);
  for (int i = 0; i < kThesisControllers; ++i) {
    const auto& operators = Find(results, ThesisName(i)).operators;
    for (int one = 0; one < count; ++one) {
      double rank = 0.0;
      for (const auto& other : operators) {
        rank += other.recorded.max_depth_m < operators[one].recorded.max_depth_m;
      }
      off[one] += std::abs(rank - 0.5 * (count - 1));
    }
  }
  return static_cast<int>(std::min_element(off.begin(), off.end()) - off.begin());
}

report::Figure Trajectories(const std::vector<GroupResult>& results) {
  constexpr int kEvery = 6;  // of the recorded positions: 24 a second
  const double wall = TrialPlaces().WallX();
  report::Figure figure;
  figure.name = "fig-5-6";
  figure.title = "Tip trajectories of the operator in the middle";
  figure.caption =
      "As the EM sensor recorded them, in the vertical plane; the forbidden region is right of the "
      "dashed line. Axes are scaled differently, as in the thesis.";
  figure.x_label = "depth beyond the wall (mm)";
  figure.y_label = "height (mm)";
  const int who = MedianOperator(results);
  for (int i = kThesisControllers - 1; i >= 0; --i) {
    report::FigureTrace trace{.name = ThesisName(i), .color = ColorOf(ThesisName(i))};
    const auto& path = Find(results, ThesisName(i)).operators[who].recorded_path;
    for (std::size_t k = 0; k < path.size(); k += kEvery) {
      if (path[k].x() < wall - 0.004) continue;
      trace.x.push_back(1e3 * (path[k].x() - wall));
      trace.y.push_back(1e3 * path[k].z());
    }
    figure.traces.push_back(trace);
  }
  figure.traces.push_back(
      {.name = "wall", .x = {0, 0}, .y = {-25, 25}, .color = "#222222", .dashed = true});
  return figure;
}

report::Figure TimeAtDepth(const std::vector<GroupResult>& results) {
  constexpr double kLeast_mm = -2.0, kMost_mm = 4.0, kBin_mm = 0.1;
  constexpr int kBins = static_cast<int>((kMost_mm - kLeast_mm) / kBin_mm);
  const double wall = TrialPlaces().WallX();
  report::Figure figure;
  figure.name = "fig-5-7";
  figure.title = "Time spent at each depth";
  figure.caption =
      "Average over the operators, in steps of 0.1 mm, as the EM sensor recorded it. Right of zero "
      "is "
      "forbidden.";
  figure.x_label = "depth beyond the wall (mm)";
  figure.y_label = "time (s per 0.1 mm)";
  for (int i = kThesisControllers - 1; i >= 0; --i) {
    const GroupResult& group = Find(results, ThesisName(i));
    report::FigureTrace trace{.name = ThesisName(i), .color = ColorOf(ThesisName(i))};
    for (int bin = 0; bin < kBins; ++bin) trace.x.push_back(kLeast_mm + (bin + 0.5) * kBin_mm);
    trace.y.assign(kBins, 0.0);
    for (const auto& one : group.operators) {
      for (const auto& p : one.recorded_path) {
        const double bin = std::floor((1e3 * (p.x() - wall) - kLeast_mm) / kBin_mm);
        if (bin >= 0 && bin < kBins) {
          trace.y[static_cast<std::size_t>(bin)] +=
              1.0 / one.rate_hz / static_cast<double>(group.operators.size());
        }
      }
    }
    figure.traces.push_back(trace);
  }
  return figure;
}

/// Where the true tip went at most, by what measures it.
report::Figure Sensing(const std::vector<GroupResult>& results) {
  report::Figure figure;
  figure.name = "fig-5-sensing";
  figure.title = "EM at 144 Hz against vision";
  figure.caption =
      "Deepest place of the true tip beyond the wall, mean over the operators with standard error; "
      "below "
      "zero it never went in. Vision is 30 ms (60 Hz) or 50 ms (30 Hz) late and hidden 5 % of the "
      "time.";
  figure.y_label = "deepest true place (mm)";
  const std::pair<const char*, const char*> sensors[] = {
      {"EM 144 Hz", ""}, {"vision 60 Hz", " vision 60 Hz"}, {"vision 30 Hz", " vision 30 Hz"}};
  for (const char* kind : {"Straight-Track", "Flex-Track", "Rod-Track"}) {
    report::FigureTrace trace{
        .name = kind, .kind = report::FigureTrace::Kind::kBars, .color = ColorOf(kind)};
    for (const auto& [label, suffix] : sensors) {
      const MeanSd of = Find(results, std::string(kind) + suffix).Of([](const OperatorResult& o) {
        return 1e3 * o.worst_m;
      });
      trace.labels.emplace_back(label);
      trace.y.push_back(of.mean);
      trace.y_error.push_back(of.StandardError());
    }
    figure.traces.push_back(trace);
  }
  return figure;
}

report::Figure Rates(const std::vector<GroupResult>& results) {
  report::Figure figure;
  figure.name = "fig-5-rates";
  figure.title = "Incursion against the update rate";
  figure.caption =
      "Deepest place of the true tip beyond the wall by the rate of sensor and controller alone: "
      "next to "
      "no noise, an arm that does not give way. Mean of three operators over 10 s with standard "
      "error; "
      "below zero it never went in.";
  figure.x_label = "update rate (Hz)";
  figure.y_label = "deepest true place (mm)";
  figure.log_x = true;
  for (const auto& name : CurveControllers()) {
    report::FigureTrace trace{.name = name, .color = ColorOf(name)};
    trace.dashed = name == "Rod-Track without tissue";
    for (const double rate : CurveRates()) {
      const MeanSd of = Find(results, CurveGroup(name, rate)).Of([](const OperatorResult& o) {
        return 1e3 * o.worst_m;
      });
      trace.x.push_back(rate);
      trace.y.push_back(of.mean);
      trace.y_error.push_back(of.StandardError());
    }
    figure.traces.push_back(trace);
  }
  return figure;
}

}  // namespace

std::vector<report::Figure> StudyFigures(const std::vector<GroupResult>& results) {
  report::Figure depth = Bars(
      results, [](const OperatorResult& o) { return 1e3 * o.recorded.max_depth_m; }, kThesisDepth);
  depth.name = "fig-5-8";
  depth.title = "Depth of maximum incursions";
  depth.caption =
      "Mean over the operators with one standard error, as the EM sensor recorded it. Light blue: "
      "five "
      "operators, 20 s.";
  depth.traces.insert(depth.traces.begin() + 2, FirmerDepths(results));
  depth.y_label = "maximum depth (mm)";
  report::Figure area = Bars(
      results, [](const OperatorResult& o) { return 1e6 * o.recorded.outline_area_m2; },
      kThesisOutline);
  area.name = "fig-5-9";
  area.title = "Area of the outlines in the forbidden region";
  area.caption =
      "Union of the trajectories on two orthogonal planes, summed; mean over the operators with "
      "one "
      "standard error.";
  area.y_label = "area (mm^2)";
  return {Trajectories(results), TimeAtDepth(results), depth, area,
          Sensing(results),      Rates(results)};
}

}  // namespace flextip::reproduction
