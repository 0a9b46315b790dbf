// stop.csv: a row a cycle around a stop.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace flextip::report {

/// A place over time, in mm; only rows that have one.
struct PlaceOverTime {
  std::vector<double> t_s;
  std::array<std::vector<double>, 3> p_mm;

  bool Empty() const { return t_s.empty(); }
};

/// The sensors in the order of their bits, as the table's columns have them.
inline constexpr std::array kStopSensors{"tip",    "em0",   "em1",
                                         "strain", "load0", "wrist_orientation"};

struct StopRows {
  std::vector<double> t_s;
  PlaceOverTime wanted, used, rest;
  std::array<PlaceOverTime, kStopSensors.size()> by;
  std::vector<double> ratio;    ///< chi-squared over its limit; NaN: not tested
  std::vector<int> there, out;  ///< bits
  std::vector<int> reaction;    ///< 0 goes on, 1 limit, 2 hold, 3 fault
};

/// Throws InputError where the file is missing, lacks a column, or has another word than a
/// reaction.
StopRows ReadStopRows(const std::filesystem::path& file);

}  // namespace flextip::report
