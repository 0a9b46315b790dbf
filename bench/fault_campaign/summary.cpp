#include "bench/fault_campaign/summary.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

namespace flextip::bench {
namespace {

constexpr double kTenHours_s = 36000.0;

nlohmann::json Json(const HazardCount& count) {
  return {{"runs", count.runs}, {"hazards", count.hazards}, {"per_1000", count.PerThousand()}};
}

nlohmann::json Json(const std::map<std::string, HazardCount>& counts) {
  nlohmann::json json;
  for (const auto& [name, count] : counts) json[name] = Json(count);
  return json;
}

/// A table of hazards per 1000 runs, a column a kind.
std::string Table(const char* head, const std::vector<KindFigures>& figures,
                  std::map<std::string, HazardCount> KindFigures::*counts) {
  std::set<std::string> names;
  for (const KindFigures& of : figures)
    for (const auto& [name, count] : of.*counts) names.insert(name);
  std::string text = fmt::format("\n| {} |", head), line = "|---|";
  for (const KindFigures& of : figures) text += fmt::format(" {} |", of.kind), line += "---|";
  text += " runs |\n" + line + "---|\n";
  for (const std::string& name : names) {
    int runs = 0;
    text += fmt::format("| {} |", name);
    for (const KindFigures& of : figures) {
      const auto at = (of.*counts).find(name);
      const HazardCount count = at == (of.*counts).end() ? HazardCount() : at->second;
      runs = std::max(runs, count.runs);
      text += fmt::format(" {:.0f} |", count.PerThousand());
    }
    text += fmt::format(" {} |\n", runs);
  }
  return text;
}

std::string Joined(const std::map<std::string, int>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  return text;
}

std::string KindText(const KindFigures& of) {
  std::string text = fmt::format(
      "\n{}: {:.1f} hazards per 1000 runs ({} of {}); of coarse runs {:.1f} ({} of {}).\n", of.kind,
      of.fine.PerThousand(), of.fine.hazards, of.fine.runs, of.coarse.PerThousand(),
      of.coarse.hazards, of.coarse.runs);
  text += fmt::format("  not stopped before the fault: {:.1f} ({} of {})\n",
                      of.unstopped.PerThousand(), of.unstopped.hazards, of.unstopped.runs);
  text += fmt::format("  hazards: {}; no equilibrium {}, threw {}\n", Joined(of.by_hazard),
                      of.no_equilibrium, of.threw);
  text += fmt::format("  detected {}, sensor named right {}, wrong {}; stops before a fault {}\n",
                      of.detected, of.named_right, of.named_wrong, of.false_stops);
  text += fmt::format("  jumps: {} of {} found, median {:.1f} cycles\n", of.jumps_found, of.jumps,
                      of.jump_cycles);
  text += fmt::format(
      "  drifts: {} of {} found, median at {:.2f} of their size, {:.2f} mm off the path\n",
      of.drifts_found, of.drifts, of.drift_part, 1e3 * of.drift_deviation_m);
  return text + fmt::format("  going on: {}\n", Joined(of.going_on));
}

}  // namespace

std::string FiguresJson(const std::vector<KindFigures>& figures,
                        const std::vector<HealthyRecord>& healthy) {
  nlohmann::json json;
  for (const KindFigures& of : figures) {
    nlohmann::json& kind = json["faults"][of.kind];
    kind = {{"fine", Json(of.fine)},
            {"coarse", Json(of.coarse)},
            {"unstopped", Json(of.unstopped)},
            {"by_hazard", of.by_hazard},
            {"by_fault", Json(of.by_fault)},
            {"by_size", Json(of.by_size)},
            {"by_controller", Json(of.by_controller)},
            {"by_suite", Json(of.by_suite)},
            {"no_equilibrium", of.no_equilibrium},
            {"threw", of.threw},
            {"detected", of.detected},
            {"named_right", of.named_right},
            {"named_wrong", of.named_wrong},
            {"false_stops", of.false_stops},
            {"jumps", of.jumps},
            {"jumps_found", of.jumps_found},
            {"jump_cycles_median", of.jump_cycles},
            {"drifts", of.drifts},
            {"drifts_found", of.drifts_found},
            {"drift_part_median", of.drift_part},
            {"drift_deviation_median_m", of.drift_deviation_m},
            {"going_on", of.going_on}};
  }
  for (const HealthyRecord& r : healthy) {
    json["healthy"][r.kind] = {{"runs", r.runs},
                               {"simulated_s", r.simulated_s},
                               {"stops", r.stops},
                               {"votes", r.votes},
                               {"off_path", r.off_path},
                               {"limited_cycles", r.limited_cycles},
                               {"without_equilibrium", r.without_equilibrium},
                               {"fine_stops", r.fine_stops},
                               {"fine_s", r.fine_s},
                               {"stops_by_name", r.stops_by_name},
                               {"fine_stops_by_setting", r.fine_stops_by_setting}};
  }
  return json.dump(1) + "\n";
}

std::string SummaryText(const std::vector<KindFigures>& figures,
                        const std::vector<FaultRecord>& worst) {
  std::string text = "Hazards per 1000 faulted runs\n";
  for (const KindFigures& of : figures) text += KindText(of);
  text += Table("size", figures, &KindFigures::by_size);
  text += Table("controller", figures, &KindFigures::by_controller);
  text += Table("suite", figures, &KindFigures::by_suite);
  text += Table("fault", figures, &KindFigures::by_fault);
  if (!worst.empty()) text += fmt::format("\nFarthest of {}:\n", worst.front().kind);
  for (const FaultRecord& r : worst) {
    text += fmt::format(
        "  run {}: {} {} ({}), {}{}, {}, {}: {}, {:.1f} mm; first {} {} after {:.2f} s; {}\n",
        r.number, r.fault, r.size, r.amount, r.move, r.floor ? " over a floor" : "", r.controller,
        r.suite, r.hazard, 1e3 * r.hazard_deviation_m, r.detected ? r.first_stop : "nothing",
        r.reaction, r.detection_s, r.going_on);
  }
  return text;
}

std::string HealthyText(const std::vector<HealthyRecord>& healthy) {
  std::string text = "\nHealthy hours\n";
  for (const HealthyRecord& r : healthy) {
    const auto per_ten = [](int stops, double simulated_s) {
      return simulated_s > 0.0 ? stops * kTenHours_s / simulated_s : 0.0;
    };
    text += fmt::format(
        "{}: {:.2f} h in {} runs; false stops per 10 h: {:.2f}, in runs that are fine without: "
        "{:.2f} ({} in {:.2f} h); sensors out per 10 h: {:.2f}; runs beyond 2 mm {}; limited "
        "cycles "
        "{}; no equilibrium {}\n",
        r.kind, r.simulated_s / 3600.0, r.runs, per_ten(r.stops, r.simulated_s),
        per_ten(r.fine_stops, r.fine_s), r.fine_stops, r.fine_s / 3600.0,
        per_ten(r.votes, r.simulated_s), r.off_path, r.limited_cycles, r.without_equilibrium);
    if (r.stops > 0) text += fmt::format("  {}\n", Joined(r.stops_by_name));
    if (r.fine_stops > 0) text += fmt::format("  fine: {}\n", Joined(r.fine_stops_by_setting));
    for (const std::string& example : r.examples) text += fmt::format("  {}\n", example);
  }
  return text;
}

}  // namespace flextip::bench
