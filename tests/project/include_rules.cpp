#include "tests/project/include_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>

namespace flextip {
namespace {

using Names = std::set<std::string>;
const std::string kClosedLoop = "simulation/closed_loop";
const std::string kFaults = "simulation/faults";
const std::string kServe = "live/serve";

Names With(Names names, const Names& more) {
  names.insert(more.begin(), more.end());
  return names;
}

/// Returns folder -> the folders whose headers it may include. A folder may always include its own.
/// The closed loop, its faults and the served robot are folders of their own: they join others.
const std::map<std::string, Names>& Arrows() {
  static const Names models{"core", "kinematics", "estimation", "control", "vision", "recording"};
  static const Names libraries{
      "core",     "kinematics",   "estimation",  "control",    "vision",    "recording",
      "pipeline", "plausibility", "calibration", "simulation", kClosedLoop, "diagnosis",
      "report",   "workspace",    "targets",     "exchange",   "exports",   "batch",
      "live",     kServe,         "task",        kFaults,      "stops",     "arms"};
  static const std::map<std::string, Names> arrows{
      {"cmake", {}},
      {"core", {}},
      {"batch", {"core"}},
      {"kinematics", {"core"}},
      {"estimation", {"core", "kinematics"}},
      {"control", {"core", "kinematics", "estimation"}},
      {"vision", {"core"}},
      {"recording", {"core"}},
      {"plausibility", {"core", "vision", "recording"}},
      {"exchange", {"core", "recording"}},
      {"pipeline", models},
      {"task", {"core", "control", "recording"}},
      {"stops", With(models, {"pipeline"})},
      {"live", With(models, {"pipeline", "task", "diagnosis", "stops"})},
      {kServe, {"core", "recording", "simulation", kClosedLoop, "live"}},
      {"calibration", {"core", "vision", "kinematics", "estimation", "recording"}},
      {"simulation", {"core", "recording", "vision"}},
      {kFaults, {"core", "recording", "estimation", "pipeline", "simulation"}},
      {kClosedLoop,
       {"core", "recording", "vision", "estimation", "control", "pipeline", "task", "diagnosis",
        "arms", "simulation", kFaults, "stops"}},
      {"diagnosis", {"core", "kinematics", "estimation", "recording"}},
      {"arms", {"core", "control", "recording", "diagnosis"}},
      {"report", {"core", "recording"}},
      {"workspace", {"core", "kinematics", "control", "recording", "report"}},
      {"exports", {"core", "recording", "report", "vision"}},
      {"targets", {"core", "calibration", "vision", "report"}},
      {"reproduction",
       {"core", "kinematics", "estimation", "control", "pipeline", "recording", "simulation",
        kClosedLoop, "workspace", "report", "apps"}},
      {"apps", libraries},
      {"python", libraries},
      {"examples", libraries},
      {"testdata", {"core", "recording", "simulation", "bench"}},
      {"bench", With(libraries, {"testdata"})},
      {"tests", With(libraries, {"testdata", "bench", "apps", "reproduction"})},
  };
  return arrows;
}

/// Foreign header's beginning -> the folders whose .cpp files may include it.
const std::map<std::string, Names>& ForeignHeaders() {
  static const std::map<std::string, Names> foreign{
      {"opencv2/",
       {"vision", "recording", "exchange", "calibration", "simulation", "exports", "apps", "bench",
        "tests"}},
      // The renderer draws the library's patterns.
      {"apriltag", {"vision", "simulation", "tests"}},
      {"ceres/", {"estimation", "calibration", "tests"}},
      {"igtl", {"live", "tests"}},
      {"websocketpp/", {"live", "tests"}},
      {"dds/", {"live", "tests"}},
      {"ros2.h", {"live", "tests"}},
      {"yaml-cpp/", {"recording"}},
      {"tbb/",
       {"simulation", kClosedLoop, "diagnosis", "arms", "workspace", "reproduction", "apps",
        "bench", "tests"}},
      {"geos", {"reproduction"}},
      {"boost/", {"control", "workspace", "reproduction"}},
      {"nlohmann/",
       {"exchange", "live", "report", "exports", "reproduction", "apps", "bench", "testdata",
        "tests"}},
      {"CLI/", {"reproduction", "apps", "bench", "testdata"}},
      {"pybind11/", {"python"}},
      {"mpi.h", {"batch"}},
      {"cereal/", {"diagnosis"}},
  };
  return foreign;
}
/// Headers of these folders are a program's own, not a library's.
const Names kPrograms{"apps", "bench", "tests", "testdata", "reproduction", "python"};

struct Include {
  std::size_t line = 0;
  std::string what;
};

std::vector<Include> IncludesOf(const std::string& text) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    std::smatch match;
    if (std::regex_search(line, match, pattern)) includes.push_back({number, match[1]});
  }
  return includes;
}

std::string FolderOf(const std::string& path) {
  for (const std::string& folder : {kClosedLoop, kFaults, kServe})
    if (path.starts_with(folder + "/")) return folder;
  return path.substr(0, path.find('/'));
}

/// Returns all project headers that `path` includes, directly or through others.
Names Reachable(const SourceTree& tree, const std::string& path) {
  Names seen;
  std::vector<std::string> open{path};
  while (!open.empty()) {
    const std::string file = open.back();
    open.pop_back();
    for (const auto& include : IncludesOf(tree.at(file))) {
      if (tree.contains(include.what) && seen.insert(include.what).second) {
        open.push_back(include.what);
      }
    }
  }
  return seen;
}

std::string ArrowComplaint(const std::string& path, const std::string& header) {
  const std::string folder = FolderOf(path), other = FolderOf(header);
  if (!Arrows().contains(other) || other == folder) return "";
  return Arrows().at(folder).contains(other) ? "" : fmt::format("which {} may not use", folder);
}

std::string ForeignComplaint(const std::string& path, const std::string& header) {
  const std::string folder = FolderOf(path);
  for (const auto& [beginning, folders] : ForeignHeaders()) {
    if (!header.starts_with(beginning)) continue;
    if (!folders.contains(folder)) return fmt::format("which is not for {}", folder);
    if (path.ends_with(".h") && !kPrograms.contains(folder)) return "foreign types in a header";
  }
  return "";
}

/// The plant shares no solver with what is tested against it, not even through a third header.
std::string PlantComplaint(const SourceTree& tree, const std::string& path) {
  if (FolderOf(path) != "simulation" && FolderOf(path) != "testdata") return "";
  for (const auto& header : Reachable(tree, path)) {
    if (FolderOf(header) == "kinematics") {
      return fmt::format("{}: reaches {}, but the plant has no part of the models", path, header);
    }
  }
  return "";
}

}  // namespace

const std::map<std::string, std::set<std::string>>& IncludeArrows() { return Arrows(); }

std::vector<std::string> IncludeViolations(const SourceTree& tree) {
  std::vector<std::string> violations;
  for (const auto& [path, text] : tree) {
    if (!Arrows().contains(FolderOf(path))) {
      violations.push_back(fmt::format("{}: is in a folder without rules", path));
      continue;
    }
    for (const auto& include : IncludesOf(text)) {
      for (const auto& why :
           {ArrowComplaint(path, include.what), ForeignComplaint(path, include.what)}) {
        if (why.empty()) continue;
        violations.push_back(
            fmt::format("{}:{}: includes {}, {}", path, include.line, include.what, why));
      }
    }
    const auto plant = PlantComplaint(tree, path);
    if (!plant.empty()) violations.push_back(plant);
  }
  return violations;
}

}  // namespace flextip
