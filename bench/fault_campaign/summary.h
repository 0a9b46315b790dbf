// The campaign's figures.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/fault_campaign/healthy.h"
#include "bench/fault_campaign/record.h"

namespace flextip::bench {

struct HazardCount {
  int runs = 0, hazards = 0;
  double PerThousand() const { return runs > 0 ? 1000.0 * hazards / runs : 0.0; }
};

/// One kind of supervision.
struct KindFigures {
  std::string kind;
  HazardCount fine;       ///< runs that keep within 2 mm of the path without fault
  HazardCount coarse;     ///< the others: counted from 2 mm beyond their own deviation
  HazardCount unstopped;  ///< of `fine` those without a stop before the fault
  std::map<std::string, int> by_hazard;  ///< of both: "path", "command", ...
  std::map<std::string, HazardCount> by_fault, by_size, by_controller, by_suite;  ///< of both
  int no_equilibrium = 0, threw = 0;
  std::map<std::string, int> going_on;
  int false_stops = 0;  ///< runs with a stop before the fault; they count in nothing below
  int detected = 0, named_right = 0, named_wrong = 0;
  /// Of tip, em0 or wrist that jump by 5 mm or more (offset, spike, wrong tag): found, of how many,
  /// and the median of the cycles.
  int jumps = 0, jumps_found = 0;
  double jump_cycles = 0.0;
  /// Of drifts: the median part of the final size at detection, and the deviation then (m).
  int drifts = 0, drifts_found = 0;
  double drift_part = 0.0, drift_deviation_m = 0.0;
};

std::vector<KindFigures> FiguresOf(const std::vector<FaultRecord>& records);

/// Returns the `count` runs with a hazard that went farthest, of the strictest kind of supervision
/// there is. Coarse runs go far by themselves and are left out.
std::vector<FaultRecord> Worst(const std::vector<FaultRecord>& records, std::size_t count);

/// Joins the cases, kind by kind.
std::vector<HealthyRecord> JoinedHealthy(const std::vector<HealthyBatch>& cases);

std::string FiguresJson(const std::vector<KindFigures>& figures,
                        const std::vector<HealthyRecord>& healthy);
/// For the terminal and for notes, as Markdown.
std::string SummaryText(const std::vector<KindFigures>& figures,
                        const std::vector<FaultRecord>& worst);
std::string HealthyText(const std::vector<HealthyRecord>& healthy);

}  // namespace flextip::bench
