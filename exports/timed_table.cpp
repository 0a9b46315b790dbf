#include "exports/timed_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "core/rotation.h"

namespace flextip::exports {
namespace {

namespace fs = std::filesystem;

constexpr double kMostOffUnit = 1e-3;  // of a quaternion, as in a recording

bool IsTimed(const fs::path& file) {
  if (!fs::is_regular_file(file)) return false;
  std::ifstream in(file);
  std::string head;
  std::getline(in, head);
  return head.starts_with("#timestamp [ns]");
}

/// "wrist0" for wrist0/data.csv, "frames" for frames.csv.
std::string NameOf(const fs::path& relative) {
  const fs::path name = relative.filename() == "data.csv" ? relative.parent_path()
                                                          : fs::path(relative).replace_extension();
  return name.generic_string();
}

/// The columns of a vector: p_RW_x, p_RW_y, p_RW_z; empty where one is absent.
template <std::size_t N>
std::optional<std::array<const std::vector<double>*, N>> Columns(const TimedTable& table,
                                                                 const std::string& name,
                                                                 const char* axes) {
  std::array<const std::vector<double>*, N> columns;
  for (std::size_t i = 0; i < N; ++i) {
    columns[i] = table.cells.Column(fmt::format("{}_{}", name, axes[i]));
    if (columns[i] == nullptr) return std::nullopt;
  }
  return columns;
}

Trajectory Path(const TimedTable& table, const std::string& point) {
  Trajectory path{.name = table.name, .point = point};
  const auto p = *Columns<3>(table, "p_" + point, "xyz");
  const auto q = Columns<4>(table, "q_" + point, "wxyz");
  const auto d = Columns<3>(table, "d_" + point, "xyz");
  const auto* status = table.cells.Texts("status");
  for (std::size_t i = 0; i < table.cells.t_ns.size(); ++i) {
    if (status != nullptr && (*status)[i] == "lost") continue;
    TimedPose pose{.t_ns = table.cells.t_ns[i], .p = {(*p[0])[i], (*p[1])[i], (*p[2])[i]}};
    if (!pose.p.allFinite()) continue;
    const Eigen::Vector4d turn =
        q ? Eigen::Vector4d((*(*q)[0])[i], (*(*q)[1])[i], (*(*q)[2])[i], (*(*q)[3])[i])
          : Eigen::Vector4d::Constant(NAN);
    const Eigen::Vector3d along = d ? Eigen::Vector3d((*(*d)[0])[i], (*(*d)[1])[i], (*(*d)[2])[i])
                                    : Eigen::Vector3d::Constant(NAN);
    if (turn.allFinite()) {
      if (std::abs(turn.stableNorm() - 1.0) > kMostOffUnit) continue;
      pose.q = Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).normalized();
      path.has_turn = true;
    } else if (along.allFinite() && along.stableNorm() > 0.0) {
      pose.q = Eigen::Quaterniond(
          RotationWithoutTwist(Eigen::Vector3d::UnitX(), along.stableNormalized()));
      path.has_turn = true;
    }
    path.poses.push_back(pose);
  }
  return path;
}

}  // namespace

std::vector<TimedTable> ReadTimedTables(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError::At(folder.string(), 0, "is no folder, expected a recording or a result");
  }
  std::vector<TimedTable> tables;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& file = entry.path();
    if (!entry.is_regular_file() || file.extension() != ".csv" || !IsTimed(file)) continue;
    TimedTable table{.name = NameOf(file.lexically_relative(folder)), .file = file};
    table.cells = report::ReadResultTable(file);
    if (table.cells.t_ns.size() != table.cells.Rows()) continue;  // "timestamp [ns]x"
    tables.push_back(std::move(table));
  }
  if (tables.empty()) {
    throw InputError::At(folder.string(), 0,
                         "holds no table over time, expected a recording or a result of track, "
                         "estimate or simulate");
  }
  std::sort(tables.begin(), tables.end(),
            [](const TimedTable& a, const TimedTable& b) { return a.name < b.name; });
  return tables;
}

std::vector<Trajectory> TrajectoriesIn(const TimedTable& table) {
  std::vector<Trajectory> paths;
  for (const std::string& column : table.cells.names) {
    const std::string bare = column.substr(0, column.find(' '));
    if (!bare.starts_with("p_") || !bare.ends_with("_x") || bare.size() < 5) continue;
    const std::string point = bare.substr(2, bare.size() - 4);
    if (!Columns<3>(table, "p_" + point, "xyz")) continue;
    Trajectory path = Path(table, point);
    if (!path.poses.empty()) paths.push_back(std::move(path));
  }
  for (Trajectory& path : paths) {
    if (paths.size() > 1) path.name += "." + path.point;
  }
  return paths;
}

}  // namespace flextip::exports
