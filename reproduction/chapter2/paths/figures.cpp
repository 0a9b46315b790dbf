#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "reproduction/chapter2/paths/moves.h"

namespace flextip::reproduction {
namespace {

report::FigureTrace Line(const TrajectoryPath& path, const std::string& name, bool dashed) {
  report::FigureTrace trace;
  trace.name = name;
  trace.dashed = dashed;
  trace.color = dashed ? "#7f7f7f" : "#1f77b4";
  for (const Eigen::Vector2d& p : path.p_tip) {
    if (!trace.x.empty() &&
        std::hypot(1e3 * p.x() - trace.x.back(), 1e3 * p.y() - trace.y.back()) < 0.05)
      continue;
    trace.x.push_back(1e3 * p.x());
    trace.y.push_back(1e3 * p.y());
  }
  return trace;
}

report::FigureTrace Points(const std::string& name, const std::string& color,
                           const std::string& symbol) {
  report::FigureTrace trace;
  trace.name = name;
  trace.kind = report::FigureTrace::Kind::kPoints;
  trace.color = color;
  trace.symbol = symbol;
  return trace;
}

report::Figure PathFigure(const std::vector<MoveResult>& results, int start) {
  report::Figure figure;
  figure.name = fmt::format("fig-2-8{}", static_cast<char>('l' + start));
  figure.title = fmt::format("From {} to eight goals (Fig. 2.8)", kStartName[start]);
  figure.caption =
      "Dashed: quasi-static steps of gain 0.01. Solid: arm with inertia, 1000 Hz PID and "
      "0.3 N of friction at the port.";
  figure.x_label = "z (mm)";
  figure.y_label = "y (mm)";
  figure.equal_axes = true;
  report::FigureTrace goals = Points("goals", "#d62728", "circle"),
                      from = Points("start", "#000000", "circle");
  for (int i = start * kGoals; i < (start + 1) * kGoals; ++i) {
    const MoveResult& r = results[i];
    const bool first = i == start * kGoals;
    figure.traces.push_back(Line(r.quasi_static, first ? "quasi-static" : "", true));
    figure.traces.push_back(
        Line(r.by_cause[kFriction].path, first ? "arm with friction" : "", false));
    goals.x.push_back(1e3 * r.move.p_goal.x());
    goals.y.push_back(1e3 * r.move.p_goal.y());
    from.x = {1e3 * r.move.p_start.x()};
    from.y = {1e3 * r.move.p_start.y()};
  }
  figure.traces.push_back(goals);
  figure.traces.push_back(from);
  return figure;
}

report::Figure CauseFigure(const std::vector<MoveResult>& results) {
  report::Figure figure;
  figure.name = "fig-2-8-causes";
  figure.title = "What takes the paths from N off the quasi-static ones";
  figure.caption =
      "Largest distance from the path by steps, one cause at a time: inertia and PID; 0.3 N of "
      "friction besides; the shaft's 0.11 N, unbalanced, without friction. A move whose shaft "
      "left the port is cut off there.";
  figure.x_label = "goal";
  figure.y_label = "distance (mm)";
  figure.log_y = true;
  for (const auto& [cause, name] :
       {std::pair{kDynamics, "dynamics alone"}, std::pair{kFriction, "with friction"},
        std::pair{kWeight, "with the shaft's weight"}}) {
    report::FigureTrace bars;
    bars.name = name;
    bars.kind = report::FigureTrace::Kind::kBars;
    for (int i = 2 * kGoals; i < kMoves; ++i) {
      bars.labels.push_back(fmt::format("({:.0f}, {:.0f})", 1e3 * results[i].move.p_goal.x(),
                                        1e3 * results[i].move.p_goal.y()));
      bars.y.push_back(results[i].by_cause[cause].deviation_mm);
    }
    figure.traces.push_back(bars);
  }
  return figure;
}

report::Figure SweepFigure(const std::vector<MoveResult>& results) {
  report::Figure figure;
  figure.name = "fig-2-8-friction";
  figure.title = "Friction and the paths from N";
  figure.caption = "Solid: the three goals further out. Dashed: the five others.";
  figure.x_label = "friction at the port (N)";
  figure.y_label = "largest distance from the path by steps (mm)";
  for (int i = 2 * kGoals; i < kMoves; ++i) {
    report::FigureTrace line;
    const bool first = i == 2 * kGoals || i == 2 * kGoals + 2;
    if (first) line.name = IsFar(i) ? "goals at z = 435" : "the five others";
    line.color = IsFar(i) ? "#d62728" : "#7f7f7f";
    line.dashed = !IsFar(i);
    line.x.assign(kSweep_N.begin(), kSweep_N.end());
    line.y.assign(results[i].sweep_mm.begin(), results[i].sweep_mm.end());
    figure.traces.push_back(line);
  }
  return figure;
}

}  // namespace

std::vector<report::Figure> TrajectoryFigures(const std::vector<MoveResult>& results, bool quick) {
  std::vector<report::Figure> figures;
  figures.reserve(5);
  for (int start = 0; start < 3; ++start) figures.push_back(PathFigure(results, start));
  if (quick) return figures;
  figures.push_back(CauseFigure(results));
  figures.push_back(SweepFigure(results));
  return figures;
}

}  // namespace flextip::reproduction
