// The rows of one stream, from a table or a bag, by the roles of their values.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "exchange/import_log.h"
#include "exchange/import_plan.h"

namespace flextip::exchange {

/// Roles: x, y, z; qw, qx, qy, qz; r11 .. r33 (a matrix); rx, ry, rz (a rotation vector); ax, ay,
/// az (angles about the axes); fx, fy, fz; m1_y, m1_z, m2_y, m2_z; j01, j02, ... (joints).
struct StreamRows {
  std::string source;                                 ///< file or topic, for messages
  std::vector<TimeNs> t_ns;                           ///< increasing
  std::vector<long> places;                           ///< line of the table, number of the message
  std::map<std::string, std::vector<double>> values;  ///< role -> a number a row
  long missing = 0, first_missing = 0;    ///< rows left out for want of a value; the first's place
  long repeated = 0, first_repeated = 0;  ///< rows left out for the time of the row before
};

bool IsOrientationRole(const std::string& role);
/// time, length, angle, force or moment; empty for roles without a unit.
std::string UnitKindOf(const std::string& role);

/// Collects rows.
class RowTaker {
 public:
  /// `roles` in the order of the values to come. Of wrist0 the orientation may lack in a row.
  RowTaker(const std::string& stream, std::vector<std::string> roles);

  enum class Outcome : std::uint8_t { kTaken, kMissing, kRepeated, kBackwards };
  /// Takes a row; NaN is a missing value, and so is a quaternion of zeros. A row without a value,
  /// or with the time of the row before, is left out and counted. A time that runs backwards is
  /// left to the caller.
  Outcome Take(TimeNs t_ns, long place, std::vector<double> values);

  const StreamRows& rows() const { return rows_; }
  StreamRows Finish() { return std::move(rows_); }

 private:
  bool Complete(std::vector<double>& values) const;

  std::vector<std::string> roles_;
  bool orientation_may_lack_;
  StreamRows rows_;
};

/// Takes the values to SI units: those of `plan.units`, else assumed by the size of the values.
/// Completes `plan.units`. Throws NotTold where the size tells nothing.
void ToSi(const std::string& stream, StreamRows& rows, StreamPlan& plan, ImportLog& log);

/// Warns of rows that were left out, and of values that hardly ever change.
void SayRows(const std::string& stream, const StreamRows& rows, ImportLog& log);

}  // namespace flextip::exchange
