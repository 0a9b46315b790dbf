// What is kept of a faulted run under one kind of supervision: a row of table.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flextip::bench {

struct FaultRecord {
  int number = 0;
  std::string kind;         ///< of supervision
  std::string fault, size;  ///< "offset tip", "plain"
  std::string move, controller, suite;
  bool floor = false, coarse = false, pair = false;
  double start_s = 0.0, duration_s = 0.0, amount = 0.0;  ///< amount: the first fault's size
  std::string hazard;                                    ///< "none", "path force", ...
  double deviation_m = 0.0;                              ///< the largest from the fault's begin on
  double hazard_deviation_m = 0.0;                       ///< the largest in a cycle with a hazard
  double healthy_deviation_m = 0.0;                      ///< of the run without fault
  bool detected = false;     ///< a stop or a vote from the fault's begin on
  int detection_cycles = 0;  ///< 1: in the first cycle that could
  double detection_s = 0.0;  ///< since the fault's begin
  double deviation_at_detection_m = 0.0;
  double fault_part_at_detection = 0.0;  ///< of a drift's final size
  std::string first_stop, reaction;      ///< at detection; "vote" where only a vote named something
  std::string named;                     ///< "right", "wrong", or "" where no sensor was named
  bool false_stop = false;               ///< one before the fault began
  std::string going_on;                  ///< "unheld", "by itself", "after resume", "no"
  std::string outcome;                   ///< "end", "time over", "no equilibrium", "refused: ..."
};

/// One line of cases.jsonl: a case's rows.
std::string JsonLine(const std::string& name, const std::vector<FaultRecord>& records);
struct FaultCase {
  std::string name;
  std::vector<FaultRecord> records;
};
/// Throws InputError where the file holds something else. Empty where there is none.
std::vector<FaultCase> ReadFaultCases(const std::filesystem::path& file);

/// Returns table.csv: a row a run and kind, runs in order.
std::string TableText(std::vector<FaultRecord> records);

}  // namespace flextip::bench
