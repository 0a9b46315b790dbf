#include "recording/streams/series_file.h"

#include <cmath>

#include "recording/text/text.h"

namespace flextip {
namespace {

constexpr double kUnitTolerance = 1e-3;
constexpr double kUnitRounding = 1e-12;  // a unit vector of doubles is unit to about 1e-16

template <class V>
void MakeUnit(const CsvReader& csv, const std::string& what, V& v) {
  const double norm = v.norm();
  if (!(std::abs(norm - 1.0) <= kUnitTolerance)) {
    throw csv.Error(
        fmt::format("{} has length {:.6g}, expected 1 within {}", what, norm, kUnitTolerance));
  }
  if (std::abs(norm - 1.0) > kUnitRounding) v.normalize();
}

}  // namespace

std::vector<std::string> TimedColumns(const std::vector<std::string>& names) {
  std::vector<std::string> columns = {kTimeColumn};
  columns.insert(columns.end(), names.begin(), names.end());
  return columns;
}

void CheckTimeRuns(const CsvReader& csv, TimeNs last, TimeNs t_ns) {
  if (t_ns > last && t_ns - last > kLongestGap_ns) {
    throw csv.Error(
        fmt::format("time {} leaps: found {} after {}, expected at most 30 days between rows",
                    kTimeColumn, t_ns, last));
  }
  if (t_ns > last) return;
  throw csv.Error(fmt::format("time {} {}: found {}, expected more than {}", kTimeColumn,
                              t_ns < last ? "runs backwards" : "stands still", t_ns, last));
}

Eigen::Vector3d ReadVector3(const CsvReader& csv, std::size_t column) {
  return {csv.Number(column), csv.Number(column + 1), csv.Number(column + 2)};
}

Eigen::Quaterniond ReadQuaternion(const CsvReader& csv, std::size_t column) {
  Eigen::Quaterniond q(csv.Number(column), csv.Number(column + 1), csv.Number(column + 2),
                       csv.Number(column + 3));
  MakeUnit(csv, "quaternion", q);
  return q;
}

Eigen::Vector3d ReadDirection(const CsvReader& csv, std::size_t column) {
  Eigen::Vector3d d = ReadVector3(csv, column);
  MakeUnit(csv, "direction", d);
  return d;
}

bool AllEmpty(const CsvReader& csv, std::size_t column, std::size_t count) {
  std::size_t empty = 0;
  for (std::size_t i = 0; i < count; ++i) empty += csv.Empty(column + i) ? 1 : 0;
  if (empty != 0 && empty != count) {
    throw csv.Error(
        fmt::format("found {} of {} fields empty, expected all or none of them", empty, count));
  }
  return empty == count;
}

void AddVector3(CsvWriter& csv, const Eigen::Vector3d& v) { csv.Add(v.x()).Add(v.y()).Add(v.z()); }

void AddQuaternion(CsvWriter& csv, const Eigen::Quaterniond& q) {
  if (!(std::abs(q.norm() - 1.0) <= kUnitTolerance)) {
    throw WorkError("a table to be written holds a quaternion off unit length");
  }
  csv.Add(q.w()).Add(q.x()).Add(q.y()).Add(q.z());
}

void RefuseToWrite(const std::filesystem::path& file, const std::string& why) {
  throw WorkError(fmt::format("{}: not written: {}", file.string(), why));
}

void WriteTable(const std::filesystem::path& file, const CsvWriter& csv) {
  WriteTextFile(file, csv.text());
}

}  // namespace flextip
