// What a scenario or a session asks of the tip: its sections path, fixtures and control.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "control/controller.h"
#include "control/direction_controller.h"
#include "control/fixtures.h"
#include "control/supervision/supervisor_options.h"
#include "control/tip_path.h"
#include "recording/text/yaml_map.h"

namespace flextip {

/// Whether a running loop looks for causes of misfit.
struct WatchTask {
  bool running = false;
  double false_alarms_per_hour = 0.1;
};

struct TipTask {
  PathSetup path;
  ControllerOptions controller;
  std::optional<DirectionOptions> direction;  ///< where the path's waypoints have directions
  Eigen::Vector3d direction_free_axis = Eigen::Vector3d::Zero();
  Fixtures fixtures;
  SupervisorOptions supervision;
  WatchTask watch;
};

/// Reads a direction and makes it a unit vector. Throws InputError for a zero vector.
Eigen::Vector3d ReadUnit(const YamlMap& map, const std::string& key);

/// Returns which of `names` the value of `key` is, 0 where it is absent. Throws InputError for any
/// other.
std::size_t ReadChoice(const YamlMap& map, const std::string& key,
                       const std::vector<std::string>& names);

/// Returns the controller that `name`, found at `key` of `map`, names. Throws InputError with the
/// names there are, and `other`, a further one that the caller knows.
ControllerKind ReadControllerKind(const YamlMap& map, const std::string& key,
                                  const std::string& name, const std::string& other = "");

/// Reads parts of a task and adds their sections to `sections`, for the check of unknown keys.
/// Files are named relative to a folder. All throw InputError with file and line.
class TaskReader {
 public:
  TaskReader(std::filesystem::path folder, TipTask& task, std::vector<YamlMap>& sections)
      : folder_(std::move(folder)), task_(task), sections_(sections) {}

  /// Returns the section path of `map`, or the file that it names; it is then in the sections.
  YamlMap PathSection(const YamlMap& map);
  /// Reads the frame of the path's waypoints.
  PathFrame ReadPathFrame(const YamlMap& path);
  /// Reads frame, waypoints, speed and mode of `map`, which PathSection gave.
  void ReadPath(const YamlMap& map);
  /// Reads the list `fixtures` of `map`, where it has one.
  void ReadFixtures(const YamlMap& map);
  /// Reads gain, bounds, margins and the direction's control off `map`, which is in the sections
  /// already.
  void ReadControl(const YamlMap& map);
  /// Reads the section `supervisor` of `map`, where it has one.
  void ReadSupervisor(const YamlMap& map);
  /// Reads the section `diagnosis` of `map`, where it has one.
  void ReadDiagnosis(const YamlMap& map);
  /// Turns the direction's control on where the waypoints have directions. `control` and
  /// `controllers` are where to complain; `kinds` are all that will run.
  void FinishDirection(const YamlMap& control, const YamlMap& controllers,
                       const std::string& controllers_key,
                       const std::vector<ControllerKind>& kinds);

 private:
  YamlMap Section(const YamlMap& map, const std::string& key);
  void ReadDirection(const YamlMap& map);
  void ReadFixture(const YamlMap& fixture);
  ForbiddenMesh ReadForbiddenMesh(const YamlMap& map) const;
  PathGuidance ReadGuidance(const YamlMap& map);

  std::filesystem::path folder_;
  TipTask& task_;
  std::vector<YamlMap>& sections_;
};

}  // namespace flextip
