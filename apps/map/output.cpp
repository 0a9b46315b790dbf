#include "apps/map/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "workspace/map_figures.h"

namespace flextip {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

template <int N>
constexpr const char* kAxes = N == 2 ? "zy" : "xyz";

constexpr int kDigits = 6;

/// Adds numbers in order, each empty where it is not finite.
template <class Vector>
void AddAll(CsvWriter& csv, const Vector& v) {
  for (const double x : v) csv.AddOrEmpty(x, kDigits);
}

template <int N>
void AddAxes(const std::string& name, const std::string& unit, std::vector<std::string>& columns) {
  for (int i = 0; i < N; ++i) {
    columns.push_back(fmt::format("{}_{} [{}]", name, kAxes<N>[i], unit));
  }
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
  return TraceInMm({low, {high.x(), low.y()}, high, {low.x(), high.y()}, low},
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
std::vector<std::string> MapColumns(bool with_worst) {
  std::vector<std::string> columns{"slice"};
  AddAxes<N>("p_AE", "m", columns);
  AddAxes<N>("p_AW", "m", columns);
  if (N == 3) columns.emplace_back("base [rad]");
  for (const char* name :
       {"joint1 [rad]", "joint2 [rad]", "norm_G []", "phi_hat_max [deg]", "phi_max [deg]"}) {
    columns.emplace_back(name);
  }
  AddAxes<N>("v_sigma", "", columns);
  AddAxes<N>("p_phi", "", columns);
  if (with_worst) {
    columns.emplace_back("worst_norm_G []");
    columns.emplace_back("worst_phi_max [deg]");
  }
  return columns;
}

template <int N>
void AddMapRows(const std::string& slice, const WorkspaceMap<N>& map, const WorstValues& worst,
                CsvWriter& csv) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const auto& at = map.points[i];
    if (!at.state) continue;
    const bool step = at.step.IsUsable(), angle = at.angle.IsUsable();
    csv.Add(slice);
    AddAll(csv, at.p_tip);
    AddAll(csv, at.state->p_wrist);
    AddAll(csv, at.state->theta);
    csv.AddOrEmpty(step ? at.step.norm : kNone, kDigits);
    csv.AddOrEmpty(step ? kDegrees * at.step.phi_hat_max_rad : kNone, kDigits);
    csv.AddOrEmpty(angle ? kDegrees * at.angle.phi_max_rad : kNone, kDigits);
    AddAll(csv, at.step.v_sigma);
    AddAll(csv, at.angle.p_phi);
    if (!worst.norm.empty()) {
      csv.AddOrEmpty(worst.norm[i], kDigits).AddOrEmpty(kDegrees * worst.angle_rad[i], kDigits);
    }
    csv.EndRow();
  }
}

template <int N>
std::vector<report::Figure> MapFigures(const MapSetup<N>& setup, const std::string& slice,
                                       const std::string& prefix, const WorkspaceMap<N>& map) {
  constexpr double kEvery_m = 0.0125;
  const std::string in = " (" + slice + ")";
  std::vector<report::Figure> figures{
      Titled(MapFigure(map, MapQuantity::kNorm), prefix + "norm", "||G||" + in),
      Titled(MapFigure(map, MapQuantity::kPhiHat), prefix + "bound",
             "Bound on the largest angle" + in),
      Titled(MapFigure(map, MapQuantity::kPhiMax), prefix + "angle",
             "Largest angle between desired and actual motion" + in),
      Titled(DirectionFigure(map, MapDirection::kVSigma, true, kEvery_m), prefix + "v-sigma",
             "Desired motions that leave the longest error, as long as ||G|| is large" + in),
      Titled(DirectionFigure(map, MapDirection::kPPhi, true, kEvery_m), prefix + "p-phi",
             "Desired motions with the largest angle, as long as it is large" + in)};
  for (auto& figure : figures) MarkPorts(figure, setup, map.slice);
  return figures;
}

template <int N>
std::vector<report::Figure> WorstFigures(const MapSetup<N>& setup, const ToleranceTask<N>& task,
                                         const std::string& slice, const std::string& prefix,
                                         const WorkspaceMap<N>& map, const WorstValues& worst) {
  std::vector<double> norm, angle_deg;
  for (const double v : worst.norm) norm.push_back(ToDigits(v, 4));
  for (const double v : worst.angle_rad) angle_deg.push_back(ToDigits(kDegrees * v, 4));
  const std::string in = " over the bounded errors (" + slice + ")";
  std::vector<report::Figure> figures{
      Titled(MapFigure(map, MapQuantity::kNorm, norm), prefix + "worst-norm", "Worst ||G||" + in),
      Titled(MapFigure(map, MapQuantity::kPhiMax, angle_deg), prefix + "worst-angle",
             "Worst largest angle" + in)};
  for (auto& figure : figures) {
    MarkPorts(figure, setup, map.slice);
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
      Titled(MapFigure(PartAround(map, places, kMargin_m), MapQuantity::kPhiMax), "plan",
             "Paths (dashed) and where the tip goes, over the largest angle");
  const auto add = [&](const Path& path, const Followed<N>& followed, const std::string& name,
                       const std::string& color) {
    figure.traces.push_back(TraceInMm(path.points, {.name = name, .color = color, .dashed = true}));
    figure.traces.push_back(
        TraceInMm(InSlice(map.slice, followed.tips), {.name = name + ", the tip", .color = color}));
  };
  if (direct.status == PathStatus::kOk) add(direct, by_direct, "shortest", "#d55e00");
  if (planned.status == PathStatus::kOk) add(planned, by_planned, "planned", "#009e73");
  return figure;
}

template std::vector<std::string> MapColumns<2>(bool);
template std::vector<std::string> MapColumns<3>(bool);
template void AddMapRows(const std::string&, const WorkspaceMap<2>&, const WorstValues&,
                         CsvWriter&);
template void AddMapRows(const std::string&, const WorkspaceMap<3>&, const WorstValues&,
                         CsvWriter&);
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
