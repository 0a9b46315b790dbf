// Trajectories and tables for other programs, as text.
#pragma once

#include <filesystem>
#include <vector>

#include "exports/timed_table.h"

namespace flextip::exports {

/// A file that was written, and how many rows it has.
struct WrittenFile {
  std::filesystem::path file;
  std::size_t rows = 0;
  bool has_turn = true;  ///< of a trajectory: orientations are measured, not the identity
};

/// Writes each path of the tables as FOLDER/NAME.tum: a line a pose, `time_s x y z qx qy qz qw`, as
/// evo and the TUM benchmark read it; a slash of a name becomes a dash. Throws InputError where
/// there is no path, WorkError where the disk refuses.
std::vector<WrittenFile> WriteTum(const std::vector<TimedTable>& tables,
                                  const std::filesystem::path& folder);

/// In place of metres and radians.
struct TableUnits {
  bool millimetres = false, degrees = false;
};

/// Writes each table as FOLDER/NAME.csv with a header that every program reads: no `#`, units
/// joined to the name (`p_RW_x_m`), and `time_s` since the first time of all tables beside
/// `timestamp_ns`. Columns in m, m2 and rad are turned into the asked `units`.
std::vector<WrittenFile> WritePlainCsv(const std::vector<TimedTable>& tables,
                                       const std::filesystem::path& folder,
                                       const TableUnits& units = {});

/// Returns "p_RW_x_m" for "p_RW_x [m]", "status" for "status []", "x_per_s" for "x [1/s]".
std::string PlainColumn(const std::string& column);

}  // namespace flextip::exports
