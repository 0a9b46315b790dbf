#include "apps/map/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reproduction/chapter2/maps/figures.h"

namespace flextip {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

template <int N>
constexpr const char* kAxes = N == 2 ? "zy" : "xyz";

/// Empty where it is not finite.
std::string Cell(double value) {
  return std::isfinite(value) ? fmt::format(",{:.6g}", value) : ",";
}
template <class Vector>
std::string Cells(const Vector& v) {
  std::string text;
  for (const double x : v) text += Cell(x);
  return text;
}

template <int N>
std::string Columns(const std::string& name, const std::string& unit) {
  std::string text;
  for (int i = 0; i < N; ++i) text += fmt::format(",{}_{} [{}]", name, kAxes<N>[i], unit);
  return text;
}

report::Figure Titled(report::Figure figure, const std::string& name, const std::string& title) {
  figure.name = name;
  figure.title = title;
  return figure;
}

template <int N>
report::FigureTrace PartOutline(const WorkspaceMap<N>& map, const ToleranceQuestion<N>& question) {
  const Slice<N>& slice = map.slice;
  const Eigen::Vector2d least(map.right_m.front(), map.up_m.front()),
      most(map.right_m.back(), map.up_m.back());
  const Eigen::Vector2d low = slice.InPlane(question.part_min).cwiseMax(least),
                        high = slice.InPlane(question.part_max).cwiseMin(most);
  return reproduction::TraceInMm({low, {high.x(), low.y()}, high, {low.x(), high.y()}, low},
                                 {.name = "part", .color = "#1d2733"});
}

template <int N>
std::vector<Eigen::Vector2d> InSlice(const Slice<N>& slice, const std::vector<VectorN<N>>& points) {
  constexpr std::size_t kMost = 400;
  const std::size_t every = std::max<std::size_t>(1, points.size() / kMost);
  std::vector<Eigen::Vector2d> out;
  for (std::size_t i = 0; i < points.size(); i += every) out.push_back(slice.InPlane(points[i]));
  return out;
}

}  // namespace

template <int N>
std::string MapTableHeader(bool with_worst) {
  const std::string joints =
      N == 2 ? ",joint1 [rad],joint2 [rad]" : ",base [rad],joint1 [rad],joint2 [rad]";
  return "#slice" + Columns<N>("p_AE", "m") + Columns<N>("p_AW", "m") + joints +
         ",norm_G [],phi_hat_max [deg],phi_max [deg]" + Columns<N>("v_sigma", "") +
         Columns<N>("p_phi", "") + (with_worst ? ",worst_norm_G [],worst_phi_max [deg]\n" : "\n");
}

template <int N>
std::string MapTableRows(const std::string& slice, const WorkspaceMap<N>& map,
                         const WorstValues& worst) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string text;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const auto& at = map.points[i];
    if (!at.state) continue;
    const bool step = at.step.IsUsable(), angle = at.angle.IsUsable();
    text += slice + Cells(at.p_tip) + Cells(at.state->p_wrist) + Cells(at.state->theta) +
            Cell(step ? at.step.norm : kNone) +
            Cell(step ? kDegrees * at.step.phi_hat_max_rad : kNone) +
            Cell(angle ? kDegrees * at.angle.phi_max_rad : kNone) + Cells(at.step.v_sigma) +
            Cells(at.angle.p_phi);
    if (!worst.norm.empty()) text += Cell(worst.norm[i]) + Cell(kDegrees * worst.angle_rad[i]);
    text += '\n';
  }
  return text;
}

template <int N>
std::vector<report::Figure> MapFigures(const MapSetup<N>& setup, const std::string& slice,
                                       const std::string& prefix, const WorkspaceMap<N>& map) {
  constexpr double kEvery_m = 0.0125;
  const std::string in = " (" + slice + ")";
  std::vector<report::Figure> figures{
      Titled(reproduction::MapFigure(map, reproduction::MapQuantity::kNorm), prefix + "norm",
             "||G||" + in),
      Titled(reproduction::MapFigure(map, reproduction::MapQuantity::kPhiHat), prefix + "bound",
             "Bound on the largest angle" + in),
      Titled(reproduction::MapFigure(map, reproduction::MapQuantity::kPhiMax), prefix + "angle",
             "Largest angle between desired and actual motion" + in),
      Titled(
          reproduction::DirectionFigure(map, reproduction::MapDirection::kVSigma, true, kEvery_m),
          prefix + "v-sigma",
          "Desired motions that leave the longest error, as long as ||G|| is large" + in),
      Titled(reproduction::DirectionFigure(map, reproduction::MapDirection::kPPhi, true, kEvery_m),
             prefix + "p-phi",
             "Desired motions with the largest angle, as long as it is large" + in)};
  for (auto& figure : figures) reproduction::MarkPorts(figure, setup, map.slice);
  return figures;
}

template <int N>
std::vector<report::Figure> WorstFigures(const MapSetup<N>& setup, const ToleranceTask<N>& task,
                                         const std::string& slice, const std::string& prefix,
                                         const WorkspaceMap<N>& map, const WorstValues& worst) {
  std::vector<double> norm, angle_deg;
  for (const double v : worst.norm) norm.push_back(reproduction::ToDigits(v, 4));
  for (const double v : worst.angle_rad)
    angle_deg.push_back(reproduction::ToDigits(kDegrees * v, 4));
  const std::string in = " over the bounded errors (" + slice + ")";
  std::vector<report::Figure> figures{
      Titled(reproduction::MapFigure(map, reproduction::MapQuantity::kNorm, norm),
             prefix + "worst-norm", "Worst ||G||" + in),
      Titled(reproduction::MapFigure(map, reproduction::MapQuantity::kPhiMax, angle_deg),
             prefix + "worst-angle", "Worst largest angle" + in)};
  for (auto& figure : figures) {
    reproduction::MarkPorts(figure, setup, map.slice);
    if (task.question.part_min.allFinite())
      figure.traces.push_back(PartOutline(map, task.question));
  }
  return figures;
}

template <int N>
report::Figure PlanFigure(const WorkspaceMap<N>& map, const Path& direct, const Path& planned,
                          const Followed<N>& by_direct, const Followed<N>& by_planned) {
  constexpr double kMargin_m = 0.04;
  std::vector<Eigen::Vector2d> places = direct.points;
  places.insert(places.end(), planned.points.begin(), planned.points.end());
  report::Figure figure =
      Titled(reproduction::MapFigure(PartAround(map, places, kMargin_m),
                                     reproduction::MapQuantity::kPhiMax),
             "plan", "Paths (dashed) and where the tip goes, over the largest angle");
  const auto add = [&](const Path& path, const Followed<N>& followed, const std::string& name,
                       const std::string& color) {
    figure.traces.push_back(
        reproduction::TraceInMm(path.points, {.name = name, .color = color, .dashed = true}));
    figure.traces.push_back(reproduction::TraceInMm(InSlice(map.slice, followed.tips),
                                                    {.name = name + ", the tip", .color = color}));
  };
  if (direct.status == PathStatus::kOk) add(direct, by_direct, "shortest", "#d55e00");
  if (planned.status == PathStatus::kOk) add(planned, by_planned, "planned", "#009e73");
  return figure;
}

template std::string MapTableHeader<2>(bool);
template std::string MapTableHeader<3>(bool);
template std::string MapTableRows(const std::string&, const WorkspaceMap<2>&, const WorstValues&);
template std::string MapTableRows(const std::string&, const WorkspaceMap<3>&, const WorstValues&);
template std::vector<report::Figure> MapFigures(const MapSetup<2>&, const std::string&,
                                                const std::string&, const WorkspaceMap<2>&);
template std::vector<report::Figure> MapFigures(const MapSetup<3>&, const std::string&,
                                                const std::string&, const WorkspaceMap<3>&);
template std::vector<report::Figure> WorstFigures(const MapSetup<2>&, const ToleranceTask<2>&,
                                                  const std::string&, const std::string&,
                                                  const WorkspaceMap<2>&, const WorstValues&);
template std::vector<report::Figure> WorstFigures(const MapSetup<3>&, const ToleranceTask<3>&,
                                                  const std::string&, const std::string&,
                                                  const WorkspaceMap<3>&, const WorstValues&);
template report::Figure PlanFigure(const WorkspaceMap<2>&, const Path&, const Path&,
                                   const Followed<2>&, const Followed<2>&);
template report::Figure PlanFigure(const WorkspaceMap<3>&, const Path&, const Path&,
                                   const Followed<3>&, const Followed<3>&);

}  // namespace flextip
