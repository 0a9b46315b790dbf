#include "bench/fault_campaign/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "batch/line_file.h"
#include "core/error.h"

namespace flextip::bench {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FaultRecord, number, kind, fault, size, move, controller, suite,
                                   floor, coarse, pair, start_s, duration_s, amount, hazard,
                                   deviation_m, hazard_deviation_m, healthy_deviation_m, detected,
                                   detection_cycles, detection_s, deviation_at_detection_m,
                                   fault_part_at_detection, first_stop, reaction, named, false_stop,
                                   going_on, outcome)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FaultCase, name, records)

std::string JsonLine(const std::string& name, const std::vector<FaultRecord>& records) {
  return nlohmann::json(FaultCase{name, records}).dump();
}

std::vector<FaultCase> ReadFaultCases(const std::filesystem::path& file) {
  std::vector<FaultCase> cases;
  for (const std::string& line : batch::WholeLines(file)) {
    try {
      cases.push_back(nlohmann::json::parse(line).get<FaultCase>());
    } catch (const nlohmann::json::exception& error) {
      throw InputError(
          fmt::format("{}: no case of a fault campaign: {}", file.string(), error.what()));
    }
  }
  return cases;
}

std::string TableText(std::vector<FaultRecord> records) {
  std::stable_sort(records.begin(), records.end(),
                   [](const FaultRecord& a, const FaultRecord& b) { return a.number < b.number; });
  std::string text =
      "number,supervision,fault,size,amount,move,floor,controller,suite,coarse,start_s,duration_s,"
      "hazard,deviation_mm,hazard_deviation_mm,healthy_deviation_mm,detected,detection_cycles,"
      "detection_s,"
      "deviation_at_detection_mm,first_stop,reaction,named,false_stop,going_on,outcome\n";
  for (const FaultRecord& r : records) {
    text += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{:.4f},{},{},{:.4f},{:.4f},{:.4f},{},{},{:.4f},{:.4f},{},{},"
        "{},{},"
        "{},{}\n",
        r.number, r.kind, r.fault, r.size, r.amount, r.move, int(r.floor), r.controller, r.suite,
        int(r.coarse), r.start_s, r.duration_s, r.hazard, 1e3 * r.deviation_m,
        1e3 * r.hazard_deviation_m, 1e3 * r.healthy_deviation_m, int(r.detected),
        r.detection_cycles, r.detection_s, 1e3 * r.deviation_at_detection_m, r.first_stop,
        r.reaction, r.named, int(r.false_stop), r.going_on, r.outcome);
  }
  return text;
}

}  // namespace flextip::bench
