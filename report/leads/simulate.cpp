#include "report/leads/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "report/leads/numbers.h"
#include "report/result_files.h"
#include "report/stops/stops.h"

namespace flextip::report::leads {
namespace {

using Json = nlohmann::ordered_json;
using Runs = std::vector<std::pair<std::string, Json>>;

/// "rod-track" -> "rod", "track".
std::pair<std::string, std::string> ModelAndSensing(const std::string& controller) {
  const std::size_t dash = controller.find('-');
  if (dash == std::string::npos) return {controller, ""};
  return {controller.substr(0, dash), controller.substr(dash + 1)};
}

/// How much less deviation the best controller has than `without`; empty where that did not run or
/// is as good.
std::string GainOver(const Runs& runs, const std::string& without, const char* of) {
  const auto it =
      std::find_if(runs.begin(), runs.end(), [&](const auto& r) { return r.first == without; });
  if (it == runs.end()) return "";
  const double best = Number(runs.front().second, "max_deviation_m");
  const double factor = best > 0.0 ? Number(it->second, "max_deviation_m") / best : 0.0;
  return factor > 1.05 ? fmt::format("{} divides the deviation by {:.2g}", of, factor) : "";
}

/// Why the best controller is best: beside those that differ from it in one thing.
std::string WhyBest(const Runs& runs) {
  const auto [model, sensing] = ModelAndSensing(runs.front().first);
  const std::string bending = GainOver(runs, "straight-" + sensing, "knowing that the shaft bends");
  const std::string seeing = GainOver(runs, model + "-calculate", "measuring the tip");
  if (bending.empty() && seeing.empty()) return "";
  std::string why = seeing.empty() || bending.empty() ? seeing + bending : seeing + ", " + bending;
  why[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(why[0])));
  return " " + why + ".";
}

/// Updates of a run that ended otherwise than "ok", of control or tip.
double Failed(const Json& run) {
  double failed = 0.0;
  for (const char* key : {"control_statuses", "tip_statuses"}) {
    const nlohmann::ordered_json statuses = run.value(key, nlohmann::ordered_json::object());
    for (const auto& [status, count] : statuses.items())
      failed += status == "ok" ? 0.0 : count.get<double>();
  }
  return failed;
}

}  // namespace

/// Controllers by their largest deviation, the best first.
Head SimulateLead(const std::filesystem::path& folder) {
  const Json summary = Json::parse(ReadBytes(folder / "summary.json"), nullptr, false);
  if (!summary.is_object()) return {};
  Runs runs;
  const Json controllers = summary.value("controllers", Json::object());
  for (const auto& [name, run] : controllers.items()) {
    if (run.is_object() && Has(run, "max_deviation_m")) runs.emplace_back(name, run);
  }
  if (runs.empty()) return {};
  std::stable_sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) {
    return Number(a.second, "max_deviation_m") < Number(b.second, "max_deviation_m");
  });
  const auto& [best, run] = runs.front();
  Head lead{.grade = kGood,
            .says = fmt::format("{} keeps the tip within {} of the desired path ({} RMS).", best,
                                Value(run, "max_deviation_m"), Value(run, "rms_deviation_m"))};
  if (runs.size() > 1) {
    const auto& [worst, other] = runs.back();
    lead.more =
        fmt::format("It is the best of {} controllers; the worst, {}, lets it go {} astray.",
                    runs.size(), worst, Value(other, "max_deviation_m")) +
        WhyBest(runs);
  }
  // Of a single run; of several each has its sentence beside its picture.
  if (const auto stops = StopsIn(folder); !stops.empty()) {
    lead.grade = kBeware;
    lead.more = lead.says;
    lead.says = StopSays(stops.front());
  }
  for (const auto& [name, each] : runs) {
    if (Failed(each) == 0.0) continue;
    lead.grade = kBeware;
    lead.reasons.push_back(fmt::format("{}: {:.0f} of {} updates did not go well", name,
                                       Failed(each), Count(each, "updates")));
  }
  lead.next = "let a diagnosis look for the causes of what is left, in the recording of this run";
  lead.command = fmt::format("flextip diagnose RESULT{} -o RESULT-cause",
                             runs.size() > 1 ? "/" + best : std::string());
  return lead;
}

}  // namespace flextip::report::leads
