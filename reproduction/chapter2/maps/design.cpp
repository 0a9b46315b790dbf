// The measures as a design tool: tolerances and paths (2.4).
#include <fmt/format.h>

#include "reproduction/chapter2/maps/pictures.h"
#include "reproduction/chapter2/maps/study.h"
#include "workspace/map_figures.h"

namespace flextip::reproduction {
namespace {

constexpr double kMm = 1000.0;

struct Part {
  const char* name;
  Eigen::Vector2d low, high;  ///< (z, y), m
};

/// The largest error that keeps ||G|| below 1 in the part, in mm.
TableRow ToleranceRow(const WorkspaceMap<2>& map, const Part& part,
                      const Eigen::Vector2d& half_width_mm, const std::string& of,
                      const std::string& note) {
  ToleranceQuestion<2> question;
  question.bounds.half_width.port_m = half_width_mm / kMm;
  question.bounds.shape = BoundShape::kEllipsoid;
  question.part_min = part.low;
  question.part_max = part.high;
  const auto tolerance = FindTolerance(ThesisSetup({0.0, 0.0}), map, question);
  const bool found = tolerance.status == ToleranceStatus::kOk;
  const Eigen::Vector2d where = found ? map.points[tolerance.point].p_tip : Eigen::Vector2d::Zero();
  return {fmt::format("2.4 port error in {} that keeps ||G|| < 1 {}", of, part.name),
          {},
          found ? std::optional(tolerance.scale) : std::nullopt,
          "mm",
          fmt::format("{}Passed first with the tip at z = {:.0f}, y = {:.0f} mm.", note,
                      kMm * where.x(), kMm * where.y())};
}

struct Travelled {
  Path path;
  Followed<2> followed;
};

Travelled Travel(const WorkspaceMap<2>& map, const PlanOptions& options) {
  const Eigen::Vector2d start(0.300, -0.230), goal(0.180, -0.230);
  Travelled travelled{.path = PlanMotion(map, start, goal, options), .followed = {}};
  if (travelled.path.status == PathStatus::kOk)
    travelled.followed = FollowPath<2>(ThesisSetup(kThesisError), travelled.path.points, {});
  return travelled;
}

void AddRows(std::vector<TableRow>& rows, const Travelled& travelled, const std::string& name,
             const std::string& note) {
  const bool arrived = travelled.followed.status == FollowStatus::kOk;
  const auto mm = [&](double m) { return arrived ? std::optional(kMm * m) : std::nullopt; };
  rows.push_back({"2.4 length of the " + name, {}, kMm * travelled.path.length_m, "mm", note});
  rows.push_back({"2.4 largest deviation from the " + name,
                  {},
                  mm(travelled.followed.max_deviation_m),
                  "mm",
                  ""});
  rows.push_back({"2.4 mean deviation from the " + name,
                  {},
                  mm(travelled.followed.mean_deviation_m),
                  "mm",
                  ""});
}

void AddTraces(report::Figure& figure, const Travelled& travelled, const std::string& name,
               const std::string& color) {
  figure.traces.push_back(
      TraceInMm(travelled.path.points, {.name = name, .color = color, .dashed = true}));
  std::vector<Eigen::Vector2d> tips;
  constexpr std::size_t kEvery = 10;
  for (std::size_t i = 0; i < travelled.followed.tips.size(); i += kEvery)
    tips.push_back(travelled.followed.tips[i]);
  figure.traces.push_back(TraceInMm(tips, {.name = name + ", the tip", .color = color}));
}

}  // namespace

std::vector<TableRow> StudyTolerances(double spacing_m) {
  const auto map = ComputeMap(ThesisSetup({0.0, 0.0}), {}, spacing_m);
  const Part line{"from L to N", {0.320, 0.0}, {0.415, 0.0}};
  const Part whole_line{"on all of y = 0", {0.26, 0.0}, {1.0, 0.0}};
  const Part middle{"in z 260 to 360, y -100 to 50 mm", {0.26, -0.10}, {0.36, 0.05}};
  const Part all{"in all of the workspace", {-1.0, -1.0}, {1.0, 1.0}};
  std::vector<TableRow> rows;
  for (const Part& part : {line, whole_line}) {
    rows.push_back(ToleranceRow(map, part, {0.0, 1.0}, "y",
                                "The thesis: y errors are less tolerable along y = 0. "));
    rows.push_back(ToleranceRow(map, part, {1.0, 0.0}, "z", ""));
  }
  rows.push_back(ToleranceRow(map, middle, {1.0, 1.0}, "any direction", ""));
  rows.push_back(
      ToleranceRow(map, all, {1.0, 1.0}, "any direction",
                   "On a grid of 5 mm: with the tip in the port none is small enough. "));
  return rows;
}

PathStudy StudyPaths(double spacing_m) {
  const auto map = ComputeMap(ThesisSetup(kThesisError), {}, spacing_m);
  const auto direct = Travel(map, {.weight = 0.0, .spacing_m = spacing_m});
  const auto indirect =
      Travel(map, {.fault = MotionFault::kStray, .weight = 10.0, .spacing_m = spacing_m});
  const auto by_angle =
      Travel(map, {.fault = MotionFault::kAngle, .weight = 2.0, .spacing_m = spacing_m});
  PathStudy study;
  AddRows(study.rows, direct, "direct path",
          "From z = 300 to 180 mm at y = -230 mm, in moves of 20 mm made of small steps.");
  AddRows(study.rows, indirect, "indirect path", "Planned: length against straying, weight 10.");
  AddRows(
      study.rows, by_angle, "path planned by the angle of its direction",
      "That angle is zero in some directions, but those next to them go far astray: such a path "
      "is longer and worse.");
  std::vector<Eigen::Vector2d> places = by_angle.path.points;
  places.insert(places.end(), direct.path.points.begin(), direct.path.points.end());
  study.figure = MapFigure(PartAround(map, places, 0.04), MapQuantity::kPhiMax);
  study.figure.name = "ch2-paths";
  study.figure.title = "2.4: a detour with less error";
  study.figure.caption =
      "Planned paths (dashed) and where the tip goes (lines), over the largest angle at each "
      "place.";
  AddTraces(study.figure, direct, "direct", "#d55e00");
  AddTraces(study.figure, indirect, "indirect", "#009e73");
  AddTraces(study.figure, by_angle, "by the angle", "#555f6b");
  return study;
}

}  // namespace flextip::reproduction
