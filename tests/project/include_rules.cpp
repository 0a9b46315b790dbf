#include "tests/project/include_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

namespace flextip {
namespace {

using Names = std::set<std::string>;

/// Folder -> the folders whose headers it may include. A folder may always include its own.
const std::map<std::string, Names>& Arrows() {
  static const std::map<std::string, Names> arrows{
      {"core", {}},
      {"kinematics", {"core"}},
      {"estimation", {"core", "kinematics"}},
      {"control", {"core", "kinematics", "estimation"}},
      {"vision", {"core"}},
      {"recording", {"core"}},
      {"calibration", {"core", "vision", "kinematics", "estimation", "recording"}},
      {"pipeline", {"core", "kinematics", "estimation", "control", "vision", "recording"}},
      {"simulation", {"core", "recording", "vision"}},
      {"diagnosis", {"core", "kinematics", "estimation", "recording"}},
      {"report", {"core", "recording"}},
      {"workspace", {"core", "kinematics", "control", "recording", "report"}},
      {"reproduction",
       {"core", "kinematics", "estimation", "control", "pipeline", "simulation", "workspace",
        "report", "recording", "apps"}},
      {"testdata", {"core", "recording", "simulation", "bench"}},
      {"apps",
       {"core", "kinematics", "estimation", "control", "vision", "recording", "calibration",
        "pipeline", "simulation", "diagnosis", "report", "workspace"}},
      {"bench",
       {"core", "kinematics", "estimation", "control", "vision", "recording", "calibration",
        "pipeline", "simulation", "diagnosis", "report", "workspace", "testdata"}},
  };
  return arrows;
}

/// The files of the target closed_loop join the plant with the controllers, and no others do.
const Names kClosedLoop{"core",       "recording", "vision",   "control",
                        "estimation", "pipeline",  "diagnosis"};

/// Foreign header's beginning -> the folders whose .cpp files may include it.
const std::map<std::string, Names>& ForeignHeaders() {
  static const std::map<std::string, Names> foreign{
      {"opencv2/", {"vision", "recording", "calibration", "simulation", "apps", "bench"}},
      {"apriltag", {"vision", "simulation"}},  // the renderer draws the library's patterns
      {"ceres/", {"estimation", "vision", "calibration", "diagnosis"}},
      {"yaml-cpp/", {"recording", "simulation", "diagnosis", "apps"}},
      {"tbb/", {"vision", "simulation", "diagnosis", "workspace", "reproduction", "apps", "bench"}},
      {"geos", {"reproduction"}},
      {"boost/", {"workspace", "reproduction"}},
      {"nlohmann/", {"report", "reproduction", "apps", "testdata", "bench"}},
      {"CLI/", {"apps", "reproduction", "bench"}},
  };
  return foreign;
}
/// Headers of these folders are the program's own, not part of the libraries.
const Names kPrograms{"apps", "bench"};

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

std::string FolderOf(const std::string& path) { return path.substr(0, path.find('/')); }

bool ClosesTheLoop(const std::string& path) {
  return path.starts_with("simulation/closed_loop") || path.starts_with("simulation/scenario");
}

/// All project headers that `path` includes, directly or through others.
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
  const Names& allowed = ClosesTheLoop(path) ? kClosedLoop : Arrows().at(folder);
  return allowed.contains(other) ? "" : fmt::format("which {} may not use", folder);
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
  const bool plant = FolderOf(path) == "simulation" || FolderOf(path) == "testdata";
  if (!plant || ClosesTheLoop(path)) return "";
  for (const auto& header : Reachable(tree, path)) {
    if (FolderOf(header) == "kinematics") {
      return fmt::format("{}: reaches {}, but the plant has no part of the models", path, header);
    }
  }
  return "";
}

}  // namespace

SourceTree ReadSourceTree(const std::filesystem::path& root) {
  SourceTree tree;
  for (const auto& [folder, unused] : Arrows()) {
    if (!std::filesystem::is_directory(root / folder)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const auto extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp") continue;
      std::ifstream file(entry.path());
      tree[entry.path().lexically_relative(root).generic_string()] = {
          std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    }
  }
  return tree;
}

std::vector<std::string> IncludeViolations(const SourceTree& tree) {
  std::vector<std::string> violations;
  for (const auto& [path, text] : tree) {
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
