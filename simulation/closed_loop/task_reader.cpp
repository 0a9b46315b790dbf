#include "simulation/closed_loop/task_reader.h"

#include "core/error.h"
#include "simulation/closed_loop/mesh_file.h"

namespace flextip::simulation {
namespace {

class TaskReader {
 public:
  TaskReader(const YamlMap& top, const std::filesystem::path& folder, Scenario& scenario,
             std::vector<YamlMap>& sections)
      : top_(top), folder_(folder), scenario_(scenario), sections_(sections) {}

  void Read() {
    ReadPath();
    ReadControllers();
    if (top_.Has("control")) ReadControl(Section(top_, "control"));
    if (top_.Has("fixtures")) {
      for (const YamlMap& fixture : top_.Maps("fixtures")) ReadFixture(fixture);
    }
    CheckDirection();
  }

 private:
  YamlMap Section(const YamlMap& map, const std::string& key) {
    sections_.push_back(map.Map(key));
    return sections_.back();
  }

  /// Which of `names` the value of `key` is, the first where it is absent.
  static std::size_t Choice(const YamlMap& map, const std::string& key,
                            const std::vector<std::string>& names) {
    const std::string found = map.TextOr(key, names.front());
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == found) return i;
    throw map.Error(key, fmt::format("found '{}', expected {}", found, fmt::join(names, " or ")));
  }

  void ReadPath() {
    const YamlMap map = Section(top_, "path");
    PathSetup& path = scenario_.loop.path;
    path.mode = Choice(map, "mode", {"continuous", "steps"}) == 1 ? PathMode::kSteps
                                                                  : PathMode::kContinuous;
    for (const YamlMap& waypoint : map.Maps("waypoints")) {
      sections_.push_back(waypoint);
      path.waypoints_m.push_back(waypoint.Vector3("to_m"));
      if (waypoint.Has("direction")) path.directions.push_back(ReadUnit(waypoint, "direction"));
    }
    if (path.waypoints_m.empty()) throw map.Error("waypoints", "found none, expected at least one");
    if (!path.directions.empty() && path.directions.size() != path.waypoints_m.size()) {
      throw map.Error("waypoints", fmt::format("found a direction at {} of {} waypoints, expected "
                                               "one at each or none",
                                               path.directions.size(), path.waypoints_m.size()));
    }
    path.speed_m_s = map.PositiveOr("speed_m_s", path.speed_m_s);
    path.settle_s = map.NonNegativeOr("settle_s", path.settle_s);
    path.step_m = map.PositiveOr("step_m", path.step_m);
    path.reached_m = map.PositiveOr("reached_m", path.reached_m);
  }

  void ReadControllers() {
    if (top_.IsList("controllers")) {
      for (const std::string& name : top_.Texts("controllers")) AddController(name);
    } else if (top_.Text("controllers") == "all") {
      for (int i = 0; i < kControllerKinds; ++i)
        scenario_.controllers.push_back(static_cast<ControllerKind>(i));
    } else {
      AddController(top_.Text("controllers"));
    }
  }

  void AddController(const std::string& name) {
    const auto kind = ControllerKindNamed(name);
    if (!kind) {
      std::string known = "all";
      for (int i = 0; i < kControllerKinds; ++i)
        known += std::string(", ") + Name(static_cast<ControllerKind>(i));
      throw top_.Error("controllers", fmt::format("found '{}', expected some of {}", name, known));
    }
    scenario_.controllers.push_back(*kind);
  }

  void ReadControl(const YamlMap& map) {
    ControllerOptions& options = scenario_.loop.controller;
    options.gain = map.PositiveOr("gain", options.gain);
    options.max_step_m = map.PositiveOr("max_step_m", options.max_step_m);
    options.min_singular_value = map.PositiveOr("min_singular_value", options.min_singular_value);
    options.beam_load_law = Choice(map, "beam_load_law", {"tip_force", "port_force"}) == 1
                                ? BeamLoadLaw::kPortForce
                                : BeamLoadLaw::kTipForce;
    Fixtures& fixtures = scenario_.loop.fixtures;
    fixtures.margin_m = map.NonNegativeOr("fixture_margin_m", 0.0);
    fixtures.margin_sd = map.NonNegativeOr("fixture_margin_sd", 0.0);
    if (map.Has("direction")) ReadDirection(Section(map, "direction"));
  }

  void ReadDirection(const YamlMap& map) {
    DirectionOptions& direction = scenario_.loop.direction.emplace();
    direction.priority = Choice(map, "priority", {"weighted", "position_first"}) == 1
                             ? DirectionPriority::kPositionFirst
                             : DirectionPriority::kWeighted;
    direction.position_tolerance_m =
        map.PositiveOr("position_tolerance_m", direction.position_tolerance_m);
    direction.direction_tolerance_rad =
        map.PositiveOr("direction_tolerance_rad", direction.direction_tolerance_rad);
    if (map.Has("free_axis")) scenario_.loop.direction_free_axis = ReadUnit(map, "free_axis");
  }

  /// Directions at the waypoints turn the direction's control on.
  void CheckDirection() {
    LoopSetup& loop = scenario_.loop;
    if (loop.path.directions.empty()) {
      if (!loop.direction) return;
      throw top_.Map("control").Error("direction", "needs a direction at every waypoint of path");
    }
    if (!loop.direction) loop.direction.emplace();
    loop.direction->gain = loop.controller.gain;
    loop.direction->max_step_m = loop.controller.max_step_m;
    loop.direction->min_singular_value = loop.controller.min_singular_value;
    for (const ControllerKind kind : scenario_.controllers) {
      if (kind == ControllerKind::kRodCalculate || kind == ControllerKind::kRodTrack) continue;
      throw top_.Error("controllers",
                       fmt::format("found {}, but waypoints with a direction need rod-calculate or "
                                   "rod-track",
                                   Name(kind)));
    }
  }

  void ReadFixture(const YamlMap& fixture) {
    const std::vector<std::string> keys = fixture.Keys();
    const std::string kind = keys.size() == 1 ? keys.front() : "";
    std::vector<Fixture>& list = scenario_.loop.fixtures.list;
    if (kind == "half_space") {
      const YamlMap map = Section(fixture, kind);
      list.emplace_back(ForbiddenHalfSpace{map.Vector3("point_m"), ReadUnit(map, "normal")});
    } else if (kind == "sphere") {
      const YamlMap map = Section(fixture, kind);
      list.emplace_back(ForbiddenSphere{map.Vector3("centre_m"), map.Positive("radius_m"),
                                        IsOutsideForbidden(map)});
    } else if (kind == "mesh") {
      list.emplace_back(ReadForbiddenMesh(Section(fixture, kind)));
    } else if (kind == "guidance") {
      list.emplace_back(ReadGuidance(Section(fixture, kind)));
    } else {
      throw fixture.Error(
          kind, fmt::format("found {}, expected one of half_space, sphere, mesh, guidance",
                            fmt::join(keys, ", ")));
    }
  }

  static bool IsOutsideForbidden(const YamlMap& map) {
    return Choice(map, "forbidden", {"inside", "outside"}) == 1;
  }

  ForbiddenMesh ReadForbiddenMesh(const YamlMap& map) const {
    const std::filesystem::path file = folder_ / map.Text("file");
    TriangleMesh mesh = ReadMesh(file);
    try {
      return ForbiddenMesh(std::move(mesh), IsOutsideForbidden(map));
    } catch (const InputError& error) {
      throw map.Error("file", file.string() + ": " + error.what());
    }
  }

  PathGuidance ReadGuidance(const YamlMap& map) {
    std::vector<Eigen::Vector3d> points;
    for (const YamlMap& point : map.Maps("points")) {
      sections_.push_back(point);
      points.push_back(point.Vector3("at_m"));
    }
    try {
      return PathGuidance(std::move(points), map.NonNegativeOr("compliance", 0.0),
                          map.NonNegativeOr("free_radius_m", 0.0));
    } catch (const InputError& error) {
      throw map.Error("points", error.what());
    }
  }

  const YamlMap& top_;
  std::filesystem::path folder_;
  Scenario& scenario_;
  std::vector<YamlMap>& sections_;
};

}  // namespace

Eigen::Vector3d ReadUnit(const YamlMap& map, const std::string& key) {
  const Eigen::Vector3d v = map.Vector3(key);
  if (v.norm() < 1e-9) throw map.Error(key, "found a zero vector, expected a direction");
  return v.normalized();
}

void ReadTask(const YamlMap& top, const std::filesystem::path& folder, Scenario& scenario,
              std::vector<YamlMap>& sections) {
  TaskReader(top, folder, scenario, sections).Read();
}

}  // namespace flextip::simulation
