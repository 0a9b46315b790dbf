// The tables over time of a recording or a result, and the poses in them.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "report/result_files.h"

namespace flextip::exports {

/// A table whose first column is a time.
struct TimedTable {
  std::string name;  ///< "wrist0", or "rod-track/truth0" of a result with several recordings
  std::filesystem::path file;
  report::ResultTable cells = {};  ///< all columns, the time's first
};

/// Returns every table of FOLDER and its sub-folders whose first column is `timestamp [ns]`, by
/// name: STREAM/data.csv as STREAM, others by their file's name. Throws InputError where there is
/// none, or where one cannot be read.
std::vector<TimedTable> ReadTimedTables(const std::filesystem::path& folder);

/// A pose, or a position with a direction, of a table's row.
struct TimedPose {
  TimeNs t_ns = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
};

/// A path in R: `p_RW` of wrist0.
struct Trajectory {
  std::string name;       ///< the table's, with `.W` where the table has several points
  std::string point;      ///< "RW"
  bool has_turn = false;  ///< q is measured, or made of a direction without twist
  std::vector<TimedPose> poses = {};
};

/// Returns the paths in a table: each `p_XY_x`, `_y`, `_z` with `q_XY_*` or `d_XY_*` where there
/// are any. Left out are rows with empty cells, rows whose `status` is `lost`, and rows whose
/// quaternion is no rotation.
std::vector<Trajectory> TrajectoriesIn(const TimedTable& table);

}  // namespace flextip::exports
