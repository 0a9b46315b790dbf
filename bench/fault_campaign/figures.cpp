#include <algorithm>
#include <array>
#include <string_view>

#include "bench/fault_campaign/summary.h"
#include "core/median.h"

namespace flextip::bench {
namespace {

constexpr std::array kKinds{"none", "rate-limits", "fixed-thresholds", "full"};
constexpr double kJump_m = 0.004;  // "plain" and more, where sizes are places

bool IsJump(const FaultRecord& r) {
  constexpr std::array jumps{"offset tip",   "spike tip",   "offset em0",   "spike em0",
                             "offset wrist", "spike wrist", "wrong-tag tip"};
  return r.amount >= kJump_m && std::find(jumps.begin(), jumps.end(), r.fault) != jumps.end();
}

bool IsDrift(const FaultRecord& r) {
  return r.fault.starts_with("drift ") && !r.pair && r.size != "subtle";
}

/// Whether the loop went on. A wrist whose encoder slipped stays beside its registration: there a
/// loop must not.
std::string GoingOn(const FaultRecord& r) {
  const bool stays = r.fault.find("encoder-slip") != std::string::npos;
  return r.going_on == "no" && stays ? "no, as the fault stays" : r.going_on;
}

void Add(const FaultRecord& r, HazardCount& count) {
  ++count.runs;
  count.hazards += r.hazard != "none";
}

KindFigures OfKind(const std::string& kind, const std::vector<FaultRecord>& records) {
  KindFigures figures{.kind = kind};
  std::vector<double> jump_cycles, drift_parts, drift_deviations;
  for (const FaultRecord& r : records) {
    if (r.kind != kind) continue;
    Add(r, r.coarse ? figures.coarse : figures.fine);
    Add(r, figures.by_fault[r.pair ? "two at once" : r.fault]);
    Add(r, figures.by_size[r.size]);
    Add(r, figures.by_controller[r.controller]);
    Add(r, figures.by_suite[r.suite]);
    for (const char* hazard : {"path", "fixture", "command", "force"})
      if (r.hazard.find(hazard) != std::string::npos) ++figures.by_hazard[hazard];
    figures.no_equilibrium += r.outcome == "no equilibrium";
    figures.threw += r.outcome.starts_with("threw");
    figures.false_stops += r.false_stop;
    ++figures.going_on[GoingOn(r)];
    // A loop that was stopped before the fault keeps hazards away and finds faults by chance.
    if (r.false_stop) continue;
    if (!r.coarse) Add(r, figures.unstopped);
    figures.detected += r.detected;
    figures.named_right += r.named == "right";
    figures.named_wrong += r.named == "wrong";
    if (IsJump(r)) {
      ++figures.jumps;
      if (r.detected) jump_cycles.push_back(r.detection_cycles);
    }
    if (IsDrift(r)) {
      ++figures.drifts;
      if (r.detected) drift_parts.push_back(r.fault_part_at_detection);
      if (r.detected) drift_deviations.push_back(r.deviation_at_detection_m);
    }
  }
  figures.jumps_found = static_cast<int>(jump_cycles.size());
  figures.drifts_found = static_cast<int>(drift_parts.size());
  if (!jump_cycles.empty()) figures.jump_cycles = Median(jump_cycles);
  if (!drift_parts.empty()) figures.drift_part = Median(drift_parts);
  if (!drift_parts.empty()) figures.drift_deviation_m = Median(drift_deviations);
  return figures;
}

}  // namespace

std::vector<KindFigures> FiguresOf(const std::vector<FaultRecord>& records) {
  std::vector<KindFigures> figures;
  for (const char* kind : kKinds) {
    KindFigures of = OfKind(kind, records);
    if (of.fine.runs + of.coarse.runs > 0) figures.push_back(std::move(of));
  }
  return figures;
}

std::vector<FaultRecord> Worst(const std::vector<FaultRecord>& records, std::size_t count) {
  std::string strictest;
  for (const char* kind : kKinds) {
    if (std::any_of(records.begin(), records.end(),
                    [&](const FaultRecord& r) { return r.kind == kind; }))
      strictest = kind;
  }
  std::vector<FaultRecord> worst;
  for (const FaultRecord& r : records)
    if (r.kind == strictest && !r.coarse && r.hazard != "none") worst.push_back(r);
  std::stable_sort(worst.begin(), worst.end(), [](const FaultRecord& a, const FaultRecord& b) {
    return a.hazard_deviation_m - a.healthy_deviation_m >
           b.hazard_deviation_m - b.healthy_deviation_m;
  });
  worst.resize(std::min(worst.size(), count));
  return worst;
}

std::vector<HealthyRecord> JoinedHealthy(const std::vector<HealthyBatch>& cases) {
  std::vector<HealthyRecord> joined;
  for (const HealthyBatch& one : cases) {
    if (joined.empty())
      for (const HealthyRecord& r : one.records) joined.push_back({.kind = r.kind});
    for (std::size_t i = 0; i < std::min(joined.size(), one.records.size()); ++i) {
      const HealthyRecord& r = one.records[i];
      HealthyRecord& sum = joined[i];
      sum.runs += r.runs;
      sum.without_equilibrium += r.without_equilibrium;
      sum.simulated_s += r.simulated_s;
      sum.stops += r.stops;
      sum.votes += r.votes;
      sum.off_path += r.off_path;
      sum.limited_cycles += r.limited_cycles;
      sum.fine_stops += r.fine_stops;
      sum.fine_s += r.fine_s;
      for (const auto& [name, stops] : r.stops_by_name) sum.stops_by_name[name] += stops;
      for (const auto& [name, stops] : r.fine_stops_by_setting)
        sum.fine_stops_by_setting[name] += stops;
      for (const std::string& example : r.examples)
        if (sum.examples.size() < 20) sum.examples.push_back(example);
    }
  }
  return joined;
}

}  // namespace flextip::bench
