// What all streams share: SENSOR/data.csv as a series in increasing time, and the rotations and
// directions in it.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "recording/text/csv.h"

namespace flextip {

inline constexpr const char* kTimeColumn = "timestamp [ns]";
/// Between two rows: 30 days.
inline constexpr TimeNs kLongestGap_ns = TimeNs(30) * 24 * 3600 * 1'000'000'000;

/// "timestamp [ns]" and the names.
std::vector<std::string> TimedColumns(const std::vector<std::string>& names);

/// Throws InputError at the reader's line unless `t_ns` comes after `last`.
void CheckTimeRuns(const CsvReader& csv, TimeNs last, TimeNs t_ns);

/// Three finite numbers from `column` on.
Eigen::Vector3d ReadVector3(const CsvReader& csv, std::size_t column);
/// w, x, y, z from `column` on, off unit length by 1e-3 at most; normalised where it is not unit to
/// rounding, else kept bit for bit.
Eigen::Quaterniond ReadQuaternion(const CsvReader& csv, std::size_t column);
/// A unit vector, as strict as ReadQuaternion.
Eigen::Vector3d ReadDirection(const CsvReader& csv, std::size_t column);
/// Whether the `count` fields from `column` on are all empty. Throws where only some are.
bool AllEmpty(const CsvReader& csv, std::size_t column, std::size_t count);

void AddVector3(CsvWriter& csv, const Eigen::Vector3d& v);
void AddQuaternion(CsvWriter& csv, const Eigen::Quaterniond& q);

/// Reads `file`; `read_value(csv)` makes a value of the current row, whose column 0 is the time.
/// Throws InputError for a series without samples too.
template <class T, class ReadValue>
Series<T> ReadSeries(const std::filesystem::path& file, const std::vector<std::string>& names,
                     ReadLog& log, ReadValue read_value) {
  CsvReader csv(file, TimedColumns(names), log);
  Series<T> series;
  while (csv.Next()) {
    const TimeNs t_ns = csv.Integer(0);
    if (!series.empty()) CheckTimeRuns(csv, series.back().t_ns, t_ns);
    series.push_back({t_ns, read_value(csv)});
  }
  if (series.empty()) throw csv.Error("no samples, expected at least one whole line of data");
  return series;
}

/// Writes `file`; `add_value(csv, value)` appends a value's fields. Throws WorkError for what
/// ReadSeries would reject: no samples, or a time that does not increase or leaps.
template <class T, class AddValue>
void WriteSeries(const std::filesystem::path& file, const std::vector<std::string>& names,
                 const Series<T>& series, AddValue add_value);

/// Throws WorkError.
void RefuseToWrite(const std::filesystem::path& file, const std::string& why);
void WriteTable(const std::filesystem::path& file, const CsvWriter& csv);

template <class T, class AddValue>
void WriteSeries(const std::filesystem::path& file, const std::vector<std::string>& names,
                 const Series<T>& series, AddValue add_value) {
  if (series.empty()) RefuseToWrite(file, "a stream without samples");
  CsvWriter csv(TimedColumns(names));
  csv.KeepBounds();
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (i > 0 && series[i].t_ns <= series[i - 1].t_ns)
      RefuseToWrite(file, "time does not increase");
    if (i > 0 && series[i].t_ns - series[i - 1].t_ns > kLongestGap_ns)
      RefuseToWrite(file, "time leaps by more than 30 days");
    csv.Add(series[i].t_ns);
    add_value(csv, series[i].value);
    csv.EndRow();
  }
  WriteTable(file, csv);
}

}  // namespace flextip
