#include "reproduction/chapter2/maps/pictures.h"

#include "workspace/map_figures.h"
#include "workspace/outline.h"

namespace flextip::reproduction {
namespace {

void MarkStarts(report::Figure& figure) {
  const std::pair<const char*, Eigen::Vector2d> starts[] = {
      {"L", kStartL}, {"M", kStartM}, {"N", kStartN}};
  const char* symbols[] = {"square-open", "diamond-open", "triangle-up-open"};
  for (int i = 0; i < 3; ++i) {
    figure.traces.push_back(
        TraceInMm({starts[i].second}, {.name = starts[i].first,
                                       .kind = report::FigureTrace::Kind::kPoints,
                                       .color = "#1d2733",
                                       .symbol = symbols[i]}));
  }
}

report::Figure Named(report::Figure figure, const std::string& name, const std::string& title,
                     const std::string& caption) {
  figure.name = name;
  figure.title = title;
  figure.caption = caption;
  return figure;
}

/// Shoulder, elbow, wrist and tip in the home position.
std::vector<Eigen::Vector2d> HomePose(const PlanarInstrument& instrument) {
  const double l1 = instrument.arm.link1_m, l2 = instrument.arm.link2_m;
  return {{-l1, l2}, {0.0, l2}, {0.0, 0.0}, *instrument.Tip(Eigen::Vector2d::Zero())};
}

}  // namespace

MapSetup<2> ThesisSetup(const Eigen::Vector2d& port_error_m) {
  MapSetup<2> setup;
  setup.error.port_m = port_error_m;
  return setup;
}

const std::vector<NamedError>& FourErrors() {
  static const std::vector<NamedError> errors{{"1", "+z", {0.010, 0.0}},
                                              {"2", "-z", {-0.010, 0.0}},
                                              {"3", "+y", {0.0, 0.010}},
                                              {"4", "-y", {0.0, -0.010}}};
  return errors;
}

report::Figure DrawWorkspaces() {
  const PlanarInstrument robot;
  constexpr double kGrid_m = 0.02, kOutline_m = 0.004;
  const auto wrists = FindWristPositions(robot, kGrid_m);
  const WorkspaceMap<2> tips = ComputeMap(ThesisSetup({0.0, 0.0}), {}, kGrid_m);
  std::vector<Eigen::Vector2d> tip_points;
  for (const auto& at : tips.points)
    if (at.state) tip_points.push_back(at.p_tip);
  report::Figure figure;
  figure.x_label = "z (mm)";
  figure.y_label = "y (mm)";
  figure.equal_axes = true;
  const auto dots = [](const char* name, const char* color) {
    return report::FigureTrace{.name = name,
                               .kind = report::FigureTrace::Kind::kPoints,
                               .color = color,
                               .symbol = "circle"};
  };
  const auto line = [](const char* name, const char* color) {
    return report::FigureTrace{.name = name, .color = color};
  };
  figure.traces = {TraceInMm(wrists.not_reaching, dots("wrist, port out of reach", "#b9c2cc")),
                   TraceInMm(wrists.reaching, dots("wrist, shaft reaches the port", "#009e73")),
                   TraceInMm(tip_points, dots("tip", "#0072b2")),
                   TraceInMm(WristOutline(robot.arm, kOutline_m), line("", "#555f6b")),
                   TraceInMm(TipOutline(robot, kOutline_m), line("", "#0072b2")),
                   TraceInMm(HomePose(robot), line("links and shaft, home position", "#1d2733"))};
  MarkPorts(figure, ThesisSetup({0.0, 0.0}), {});
  return Named(std::move(figure), "fig-2-3", "Fig. 2.3: workspaces of wrist and tip",
               "Where the joint limits let the wrist be, split by whether the shaft reaches the "
               "port from there, and where the tip is then.");
}

std::vector<report::Figure> DrawMeasures(const WorkspaceMap<2>& map) {
  struct Part {
    MapQuantity quantity;
    const char *name, *title, *caption;
  };
  const Part parts[] = {
      {MapQuantity::kNorm, "fig-2-4a", "Fig. 2.4a: ||G||",
       "Port believed (20, 10) mm in (y, z) from where it is, unit gain. Past 2 the colour stays "
       "the same."},
      {MapQuantity::kPhiHat, "fig-2-4b", "Fig. 2.4b: bound on the largest angle",
       "It jumps from 90 to 180 degrees where ||G|| passes 1, so its line of 135 degrees is the "
       "line ||G|| = 1."},
      {MapQuantity::kPhiMax, "fig-2-4c",
       "Fig. 2.4c: largest angle between desired and actual motion",
       "Exact, at each place over all directions of desired motion."}};
  std::vector<report::Figure> figures;
  for (const Part& part : parts) {
    figures.push_back(Named(MapFigure(map, part.quantity), part.name, part.title, part.caption));
    MarkPorts(figures.back(), ThesisSetup(kThesisError), {});
    MarkStarts(figures.back());
  }
  return figures;
}

std::vector<report::Figure> DrawDirections(const WorkspaceMap<2>& map) {
  struct Part {
    MapDirection direction;
    bool scaled;
    const char *name, *title, *caption;
  };
  const Part parts[] = {
      {MapDirection::kVSigma, false, "fig-2-5a",
       "Fig. 2.5a: worst direction for the error's length",
       "v_sigma: the desired motion after which the error is longest."},
      {MapDirection::kVSigma, true, "fig-2-5b", "Fig. 2.5b: v_sigma, as long as ||G|| is large",
       "Full length from ||G|| = 2 on."},
      {MapDirection::kPPhi, false, "fig-2-5c", "Fig. 2.5c: worst direction for the angle",
       "p_phi: the desired motion whose actual motion is furthest off in angle."},
      {MapDirection::kPPhi, true, "fig-2-5d", "Fig. 2.5d: p_phi, as long as the angle is large",
       "Full length at 180 degrees."}};
  constexpr double kEvery_m = 0.0125;
  std::vector<report::Figure> figures;
  for (const Part& part : parts) {
    figures.push_back(Named(DirectionFigure(map, part.direction, part.scaled, kEvery_m), part.name,
                            part.title, part.caption));
    MarkPorts(figures.back(), ThesisSetup(kThesisError), {});
  }
  return figures;
}

std::vector<report::Figure> DrawFourErrors(const std::vector<WorkspaceMap<2>>& maps) {
  std::vector<report::Figure> figures;
  for (const bool bound : {true, false}) {
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const NamedError& error = FourErrors()[i];
      const auto quantity = bound ? MapQuantity::kPhiHat : MapQuantity::kPhiMax;
      const std::string letter = bound ? "a" : "b";
      figures.push_back(Named(MapFigure(maps[i], quantity), "fig-2-6" + letter + error.name,
                              std::string("Fig. 2.6") + letter + error.name + ": " +
                                  (bound ? "bound on the largest angle" : "largest angle") +
                                  ", port error 10 mm in " + error.in_words,
                              ""));
      MarkPorts(figures.back(), ThesisSetup(error.port_error_m), {});
    }
  }
  return figures;
}

}  // namespace flextip::reproduction
