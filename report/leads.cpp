#include "report/leads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "report/labels.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

using Json = nlohmann::ordered_json;

double Number(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_number() ? it->get<double>() : 0.0;
}

bool Has(const Json& json, const char* key) { return json.contains(key) && json[key].is_number(); }

std::string Value(const Json& json, const char* key) { return SpokenValue(key, Number(json, key)); }

std::string Count(const Json& json, const char* key) {
  return fmt::format("{:.0f}", Number(json, key));
}

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

/// Controllers by their largest deviation, the best first.
Lead SimulateLead(const Json& summary) {
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
  Lead lead{.says = fmt::format("{} keeps the tip within {} of the desired path ({} RMS).", best,
                                Value(run, "max_deviation_m"), Value(run, "rms_deviation_m"))};
  if (runs.size() > 1) {
    const auto& [worst, other] = runs.back();
    lead.more =
        fmt::format("It is the best of {} controllers; the worst, {}, lets it go {} astray.",
                    runs.size(), worst, Value(other, "max_deviation_m")) +
        WhyBest(runs);
  }
  return lead;
}

Lead CheckLead(const Json& summary) {
  if (!Has(summary, "wrong") || !Has(summary, "doubtful")) return {};
  const double wrong = Number(summary, "wrong"), doubtful = Number(summary, "doubtful");
  if (wrong + doubtful == 0.0) return {.says = "Nothing was found: the streams fit one another."};
  return {.says = fmt::format("{:.0f} wrong, {:.0f} doubtful.", wrong, doubtful),
          .more = "Each finding has the line that mends it, where one is known."};
}

/// The tip and the port's force of a single shape, by its row of shapes.csv.
std::string SingleShape(const std::filesystem::path& table) {
  if (!std::filesystem::exists(table)) return "";
  const ResultTable shapes = ReadResultTable(table);
  const auto first = [&](const char* column) {
    const auto* numbers = shapes.Column(column);
    return numbers == nullptr || numbers->empty() ? std::nan("") : numbers->front();
  };
  const double force = std::hypot(first("f_port_on_shaft_N_x"), first("f_port_on_shaft_N_y"),
                                  first("f_port_on_shaft_N_z"));
  if (!std::isfinite(force) || !std::isfinite(first("p_tip_m_x"))) return "";
  return fmt::format("The tip is at ({:.1f}, {:.1f}, {:.1f}) mm; the port pushes with {:.3g} N.",
                     1e3 * first("p_tip_m_x"), 1e3 * first("p_tip_m_y"), 1e3 * first("p_tip_m_z"),
                     force);
}

Lead ShapeLead(const Json& summary, const std::filesystem::path& folder) {
  if (!Has(summary, "shapes")) return {};
  if (Number(summary, "shapes") == 1) return {.says = SingleShape(folder / "shapes.csv")};
  return {.says = fmt::format("{} of {} shapes were solved.", Count(summary, "ok"),
                              Count(summary, "shapes"))};
}

Lead DetectLead(const Json& summary) {
  if (!Has(summary, "tags")) return {};
  const std::size_t pictures = summary.value("images", Json::array()).size();
  return {.says = fmt::format("{} {} found in {} {}.", Count(summary, "tags"),
                              Number(summary, "tags") == 1 ? "tag was" : "tags were", pictures,
                              pictures == 1 ? "picture" : "pictures")};
}

Lead MapLead(const Json& summary) {
  const Json slices = summary.value("slices", Json::array());
  double area_cm2 = 0.0, norm = 0.0, angle_deg = 0.0;
  for (const auto& slice : slices) {
    area_cm2 += Number(slice, "area_cm2");
    norm = std::max(norm, Number(slice, "largest_norm_G"));
    angle_deg = std::max(angle_deg, Number(slice, "largest_angle_deg"));
  }
  if (!(norm > 0.0)) return {};
  return {.says = fmt::format("A step of the tip may go up to {:.3g}° astray.", angle_deg),
          .more = fmt::format("The largest error that a step leaves is {:.3g} times the one it "
                              "found; {:.4g} cm² of the plane{} can be reached.",
                              norm, area_cm2, slices.size() == 1 ? "" : "s")};
}

/// The streams by name, and how much of them was assumed.
Lead ImportLead(const Json& summary) {
  const Json streams = summary.value("streams", Json::array());
  std::string names;
  for (const auto& stream : streams) {
    if (!names.empty()) names += ", ";
    names += stream.value("name", "");
  }
  if (names.empty()) return {};
  const std::size_t assumed = summary.value("assumed", Json::array()).size();
  const std::size_t found = summary.value("findings", Json::array()).size();
  std::string says = fmt::format("{} {} imported: {}", streams.size(),
                                 streams.size() == 1 ? "stream was" : "streams were", names);
  if (found > 0)
    says += fmt::format("; {} {} not fit", found, found == 1 ? "thing does" : "things do");
  return {.says = says + ".",
          .more = assumed == 0
                      ? "Nothing was assumed."
                      : fmt::format("{} {} assumed (below): read them before you trust a result.",
                                    assumed, assumed == 1 ? "value was" : "values were")};
}

Lead ReproduceLead(const Json& summary) {
  double numbers = 0.0, figures = 0.0, compared = 0.0, agree = 0.0;
  for (const auto& chapter : summary.value("chapters", Json::array())) {
    numbers += Number(chapter, "numbers");
    figures += Number(chapter, "figures");
    compared += Number(chapter, "compared");
    agree += Number(chapter, "agree");
  }
  if (numbers + figures == 0.0) return {};
  const std::string more =
      fmt::format("{:.0f} numbers and {:.0f} figures, done again", numbers, figures);
  if (compared == 0.0) return {.says = more + "."};
  return {.says = fmt::format("{:.0f} of {:.0f} of the thesis's numbers agree to 5 %.", agree,
                              compared),
          .more = more + "; where a number differs, its row says why."};
}

}  // namespace

Lead LeadOf(const std::filesystem::path& folder) {
  const auto file = folder / "summary.json";
  const Json summary = Json::parse(ReadBytes(file), nullptr, false);
  if (!summary.is_object()) throw InputError::At(file.string(), 0, "not an object");
  const std::string command =
      summary.contains("command") && summary["command"].is_string() ? summary["command"] : "";
  if (command == "simulate") return SimulateLead(summary);
  if (command == "check") return CheckLead(summary);
  if (command == "shape") return ShapeLead(summary, folder);
  if (command == "detect") return DetectLead(summary);
  if (command == "map") return MapLead(summary);
  if (command.starts_with("import ")) return ImportLead(summary);
  if (command == "reproduce") return ReproduceLead(summary);
  return {};
}

}  // namespace flextip::report
