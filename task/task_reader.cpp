#include "task/task_reader.h"

#include <fmt/ranges.h>

#include "core/error.h"
#include "task/mesh_file.h"
#include "task/path_time.h"

namespace flextip {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kLongestCorrection_s = 1.0;
constexpr double kMostFalseAlarms = 0.01;
constexpr double kMostDoubts = 0.1;
constexpr double kMostFalseAlarmsPerHour = 100.0;
constexpr double kAnyRate_hz = 1e3;  // of updates: two of them are all that it changes

bool IsOutsideForbidden(const YamlMap& map) {
  return ReadChoice(map, "forbidden", {"inside", "outside"}) == 1;
}

}  // namespace

Eigen::Vector3d ReadUnit(const YamlMap& map, const std::string& key) {
  const Eigen::Vector3d v = map.Vector3(key);
  if (v.norm() < 1e-9) throw map.Error(key, "found a zero vector, expected a direction");
  return v.normalized();
}

std::size_t ReadChoice(const YamlMap& map, const std::string& key,
                       const std::vector<std::string>& names) {
  const std::string found = map.TextOr(key, names.front());
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == found) return i;
  throw map.Error(key, fmt::format("found '{}', expected {}", found, fmt::join(names, " or ")));
}

ControllerKind ReadControllerKind(const YamlMap& map, const std::string& key,
                                  const std::string& name, const std::string& other) {
  if (const auto kind = ControllerKindNamed(name)) return *kind;
  std::string known = other;
  for (int i = 0; i < kControllerKinds; ++i) {
    known += std::string(known.empty() ? "" : ", ") + Name(static_cast<ControllerKind>(i));
  }
  throw map.Error(key, fmt::format("found '{}', expected some of {}", name, known));
}

YamlMap TaskReader::Section(const YamlMap& map, const std::string& key) {
  sections_.push_back(map.Map(key));
  return sections_.back();
}

YamlMap TaskReader::PathSection(const YamlMap& map) {
  const YamlMap path = Section(map, "path");
  if (!path.Has("file")) return path;
  sections_.push_back(YamlMap::Load(folder_ / path.Text("file")));
  return sections_.back();
}

PathFrame TaskReader::ReadPathFrame(const YamlMap& path) {
  const bool in_robot_frame = ReadChoice(path, "frame", {"start", "R"}) == 1;
  task_.path.frame = in_robot_frame ? PathFrame::kRobot : PathFrame::kStart;
  return task_.path.frame;
}

void TaskReader::ReadPath(const YamlMap& map) {
  PathSetup& path = task_.path;
  ReadPathFrame(map);
  path.mode = ReadChoice(map, "mode", {"continuous", "steps"}) == 1 ? PathMode::kSteps
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
  if (path.mode == PathMode::kSteps) return;
  const double seconds = PathSeconds(path, kAnyRate_hz);
  if (seconds <= kLongestPath_s) return;
  throw map.Error(map.Has("speed_m_s") ? "speed_m_s" : "waypoints",
                  fmt::format("the path takes {:.3g} s at {:g} m/s with {:g} s at its end, "
                              "expected at most {:g} s",
                              seconds, path.speed_m_s, path.settle_s, kLongestPath_s));
}

void TaskReader::ReadControl(const YamlMap& map) {
  ControllerOptions& options = task_.controller;
  options.gain = map.PositiveOr("gain", options.gain);
  options.max_step_m = map.PositiveOr("max_step_m", options.max_step_m);
  options.min_singular_value = map.PositiveOr("min_singular_value", options.min_singular_value);
  options.correction_s = map.NonNegativeOr("correction_s", options.correction_s);
  if (options.correction_s > kLongestCorrection_s) {
    throw map.Error("correction_s", fmt::format("found {:g}, expected at most {:g}",
                                                options.correction_s, kLongestCorrection_s));
  }
  options.beam_load_law = ReadChoice(map, "beam_load_law", {"tip_force", "port_force"}) == 1
                              ? BeamLoadLaw::kPortForce
                              : BeamLoadLaw::kTipForce;
  task_.fixtures.margin_m = map.NonNegativeOr("fixture_margin_m", 0.0);
  task_.fixtures.margin_sd = map.NonNegativeOr("fixture_margin_sd", 0.0);
  if (map.Has("direction")) ReadDirection(Section(map, "direction"));
}

void TaskReader::ReadDiagnosis(const YamlMap& map) {
  if (!map.Has("diagnosis")) return;
  const YamlMap section = Section(map, "diagnosis");
  WatchTask& watch = task_.watch;
  if (section.Has("running"))
    watch.running = ReadChoice(section, "running", {"false", "true"}) == 1;
  watch.false_alarms_per_hour =
      section.PositiveOr("false_alarms_per_hour", watch.false_alarms_per_hour);
  if (watch.false_alarms_per_hour > kMostFalseAlarmsPerHour) {
    throw section.Error("false_alarms_per_hour",
                        fmt::format("found {}, expected at most {}", watch.false_alarms_per_hour,
                                    kMostFalseAlarmsPerHour));
  }
}

void TaskReader::ReadSupervisor(const YamlMap& map) {
  if (!map.Has("supervisor")) return;
  const YamlMap section = Section(map, "supervisor");
  SupervisorOptions& options = task_.supervision;
  if (section.Has("kind")) {
    const std::string name = section.Text("kind");
    const auto kind = SupervisionKindNamed(name);
    if (!kind) {
      throw section.Error("kind", fmt::format("found '{}', expected none, rate-limits, "
                                              "fixed-thresholds or full",
                                              name));
    }
    options.kind = *kind;
  }
  RateLimits& rates = options.rates;
  rates.max_step_m = section.PositiveOr("max_step_m", rates.max_step_m);
  rates.max_speed_m_s = section.PositiveOr("max_speed_m_s", rates.max_speed_m_s);
  rates.max_acceleration_m_s2 =
      section.PositiveOr("max_acceleration_m_s2", rates.max_acceleration_m_s2);
  rates.max_jerk_m_s3 = section.PositiveOr("max_jerk_m_s3", rates.max_jerk_m_s3);
  if (rates.max_jerk_m_s3 > 0.0 && rates.max_acceleration_m_s2 <= 0.0)
    throw section.Error("max_jerk_m_s3", "expected max_acceleration_m_s2 beside it");
  options.resume_after_s = section.PositiveOr("resume_after_s", options.resume_after_s);
  options.fault_after_s = section.PositiveOr("fault_after_s", options.fault_after_s);
  options.stale_s = section.PositiveOr("stale_s", options.stale_s);
  options.follow_lag_s = section.PositiveOr("follow_lag_s", options.follow_lag_s);
  options.false_alarm = section.PositiveOr("false_alarm", options.false_alarm);
  if (options.false_alarm > kMostFalseAlarms)
    throw section.Error("false_alarm", "expected a probability of a cycle, at most 0.01");
  options.doubt = section.PositiveOr("doubt", options.doubt);
  if (options.doubt > kMostDoubts)
    throw section.Error("doubt", "expected a probability of a cycle, at most 0.1");
  options.doubt_s = section.PositiveOr("doubt_s", options.doubt_s);
  options.max_tip_force_N = section.PositiveOr("max_tip_force_N", options.max_tip_force_N);
  if (section.Has("max_late_cycles")) {
    const std::int64_t cycles = section.Integer("max_late_cycles");
    if (cycles < 1 || cycles > 1000) {
      throw section.Error("max_late_cycles", fmt::format("found {}, expected 1 to 1000", cycles));
    }
    options.max_late_cycles = static_cast<int>(cycles);
  }
  options.max_tip_deviation_m =
      section.PositiveOr("max_tip_deviation_m", options.max_tip_deviation_m);
  options.fixed_jump_m = section.PositiveOr("fixed_jump_m", options.fixed_jump_m);
  const double angle_deg =
      section.PositiveOr("max_motion_angle_deg", options.max_motion_angle_rad * kDegrees);
  if (angle_deg >= 90.0) {
    throw section.Error(
        "max_motion_angle_deg",
        fmt::format("found {}, expected less than 90: the tip would then go back", angle_deg));
  }
  options.max_motion_angle_rad = angle_deg / kDegrees;
}

void TaskReader::ReadDirection(const YamlMap& map) {
  DirectionOptions& direction = task_.direction.emplace();
  direction.priority = ReadChoice(map, "priority", {"weighted", "position_first"}) == 1
                           ? DirectionPriority::kPositionFirst
                           : DirectionPriority::kWeighted;
  direction.position_tolerance_m =
      map.PositiveOr("position_tolerance_m", direction.position_tolerance_m);
  direction.direction_tolerance_rad =
      map.PositiveOr("direction_tolerance_rad", direction.direction_tolerance_rad);
  if (map.Has("free_axis")) task_.direction_free_axis = ReadUnit(map, "free_axis");
}

void TaskReader::FinishDirection(const YamlMap& control, const YamlMap& controllers,
                                 const std::string& controllers_key,
                                 const std::vector<ControllerKind>& kinds) {
  if (task_.path.directions.empty()) {
    if (!task_.direction) return;
    throw control.Error("direction", "needs a direction at every waypoint of path");
  }
  if (!task_.direction) task_.direction.emplace();
  task_.direction->gain = task_.controller.gain;
  task_.direction->max_step_m = task_.controller.max_step_m;
  task_.direction->min_singular_value = task_.controller.min_singular_value;
  for (const ControllerKind kind : kinds) {
    if (kind == ControllerKind::kRodCalculate || kind == ControllerKind::kRodTrack) continue;
    throw controllers.Error(
        controllers_key,
        fmt::format("found {}, but waypoints with a direction need rod-calculate or rod-track",
                    Name(kind)));
  }
}

void TaskReader::ReadFixtures(const YamlMap& map) {
  if (!map.Has("fixtures")) return;
  for (const YamlMap& fixture : map.Maps("fixtures")) ReadFixture(fixture);
}

void TaskReader::ReadFixture(const YamlMap& fixture) {
  const std::vector<std::string> keys = fixture.Keys();
  const std::string kind = keys.size() == 1 ? keys.front() : "";
  std::vector<Fixture>& list = task_.fixtures.list;
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
    throw fixture.Error(kind,
                        fmt::format("found {}, expected one of half_space, sphere, mesh, guidance",
                                    fmt::join(keys, ", ")));
  }
}

ForbiddenMesh TaskReader::ReadForbiddenMesh(const YamlMap& map) const {
  const std::filesystem::path file = folder_ / map.Text("file");
  TriangleMesh mesh = ReadMesh(file);
  try {
    return ForbiddenMesh(std::move(mesh), IsOutsideForbidden(map));
  } catch (const InputError& error) {
    throw map.Error("file", file.string() + ": " + error.what());
  }
}

PathGuidance TaskReader::ReadGuidance(const YamlMap& map) {
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

}  // namespace flextip
