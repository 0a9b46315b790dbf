#include "apps/stops/stops.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/version.h"
#include "recording/text/text.h"
#include "report/drawing/picture.h"
#include "report/pages.h"
#include "report/stops/stops.h"

namespace flextip {
namespace {

nlohmann::ordered_json FactsJson(const StopFacts& facts) {
  nlohmann::ordered_json json{{"cause", facts.cause}, {"at_s", facts.at_s}};
  if (facts.fault_s) json["fault_s"] = *facts.fault_s;
  json["end_s"] = facts.end_s;
  json["open"] = facts.open;
  json["holds"] = facts.holds;
  if (facts.odd) {
    json["odd"] = Name(*facts.odd);
    json["odd_is_named"] = facts.odd_is_named;
    if (facts.odd_distance_m > 0.0) json["odd_distance_m"] = facts.odd_distance_m;
  }
  auto others = nlohmann::ordered_json::array();
  for (const VotedSensor sensor : facts.others) others.push_back(Name(sensor));
  json["others"] = others;
  if (facts.chi2_limit > 0.0) {
    json["chi2"] = facts.chi2;
    json["chi2_limit"] = facts.chi2_limit;
  }
  return json;
}

}  // namespace

void WriteExcerptPages(const std::filesystem::path& folder, const StopsOfRun& stops,
                       const std::vector<std::filesystem::path>& inputs) {
  auto names = nlohmann::ordered_json::array();
  for (const std::filesystem::path& input : inputs) names.push_back(input.string());
  for (const KeptStop& stop : stops.kept) {
    const nlohmann::ordered_json summary{{"command", "excerpt"}, {"version", kVersion},
                                         {"says", stop.says},    {"stop", FactsJson(stop.facts)},
                                         {"inputs", names},      {"warnings", stop.warnings}};
    WriteTextFile(folder / stop.folder / "summary.json", summary.dump(2) + "\n");
    report::WriteExcerptReport(folder / stop.folder);
    report::WritePicture(folder / stop.folder / "stop.png",
                         report::StopPicture(folder / stop.folder), 2);
  }
}

void AddStopsJson(const StopsOfRun& stops, nlohmann::ordered_json& summary) {
  if (stops.found == 0) return;
  summary["stops_found"] = stops.found;
  summary["faults"] = stops.faults;
  auto list = nlohmann::ordered_json::array();
  for (const KeptStop& stop : stops.kept)
    list.push_back({{"says", stop.says}, {"excerpt", stop.folder}});
  summary["stops"] = list;
}

void PrintStops(const StopsOfRun& stops, const std::filesystem::path& recording) {
  const std::size_t said = std::min<std::size_t>(3, stops.kept.size());
  for (std::size_t i = 0; i < said; ++i) {
    fmt::print("{}\n  its last seconds: {}\n", stops.kept[i].says,
               (recording / stops.kept[i].folder).string());
  }
  if (stops.found > said) fmt::print("and {} more stops\n", stops.found - said);
}

}  // namespace flextip
