#include "report/leads/leads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/shell_text.h"
#include "report/leads/control.h"
#include "report/leads/numbers.h"
#include "report/leads/simulate.h"
#include "report/result_files.h"

namespace flextip::report::leads {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPictures = "flextip export pictures RESULT --format pdf -o RESULT-pictures";

std::string Things(double count, const char* how) {
  return fmt::format("{:.0f} {} {}", count, count == 1 ? "thing is" : "things are", how);
}

/// The streams' names, under `key` in each.
std::vector<std::string> StreamNames(const Json& summary, const char* key) {
  std::vector<std::string> names;
  for (const auto& stream : summary.value("streams", Json::array()))
    names.push_back(stream.value(key, ""));
  return names;
}

/// What a recording is for: to be tracked, where it has pictures alone, else to be judged. The next
/// result stands beside this one, not among the recordings.
void SayUse(const std::vector<std::string>& streams, const std::string& recording, Head& head) {
  const auto has = [&](const char* name) {
    return std::find(streams.begin(), streams.end(), name) != streams.end();
  };
  const bool track = has("cam0") && !has("vision0");
  head.next = track ? "track the tip in its pictures"
                    : "let a diagnosis say what the simulation gets wrong of it";
  head.command = fmt::format("flextip {} {} -o RESULT-{}", track ? "track" : "diagnose", recording,
                             track ? "tracked" : "cause");
}

Head ExcerptLead(const Json& summary) {
  return {.grade = kBeware,
          .says = summary.value("says", ""),
          .next =
              "flextip replay gives the commands of this folder again, flextip diagnose says "
              "what the simulation gets wrong of it"};
}

Head CheckLead(const Json& summary) {
  if (!Has(summary, "wrong") || !Has(summary, "doubtful")) return {};
  const double wrong = Number(summary, "wrong"), doubtful = Number(summary, "doubtful");
  const auto streams = StreamNames(summary, "stream");
  Head head{.grade = kGood, .says = "Nothing was found: the streams fit one another."};
  SayUse(streams, "RECORDING", head);
  if (wrong + doubtful == 0.0) return head;
  head.grade = kBeware;
  head.says = "The recording is not as it says: " + Things(wrong, "wrong");
  if (wrong == 0.0)
    head.says = "The recording can be what it says, but " + Things(doubtful, "doubtful");
  if (wrong > 0.0 && doubtful > 0.0) head.says += fmt::format(", {:.0f} doubtful", doubtful);
  head.says += ".";
  if (wrong == 0.0) return head;
  head.next = "mend what is wrong, and check again";
  head.command = "flextip check RECORDING -o RESULT --force";
  return head;
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

Head ShapeLead(const Json& summary, const std::filesystem::path& folder) {
  if (!Has(summary, "shapes")) return {};
  const double shapes = Number(summary, "shapes"), ok = Number(summary, "ok");
  Head head{.grade = ok == shapes ? kGood : ok > 0.0 ? kBeware : kNotFound};
  const bool drawn = std::filesystem::exists(folder / "figures.json");
  if (drawn) {
    head.says = SingleShape(folder / "shapes.csv");
    head.next = "take the figures into a paper";
    head.command = kPictures;
  } else {
    head.says = fmt::format("{:.0f} of {:.0f} shapes were solved.", ok, shapes);
    head.next = ok == shapes
                    ? "take shapes.csv into a spreadsheet; flextip shape --plot draws a row"
                    : "look which rows of shapes.csv have another status than ok";
  }
  return head;
}

Head DetectLead(const Json& summary) {
  if (!Has(summary, "tags")) return {};
  const std::size_t pictures = summary.value("images", Json::array()).size();
  Head head{.grade = kGood,
            .says = fmt::format("{} {} found in {} {}.", Count(summary, "tags"),
                                Number(summary, "tags") == 1 ? "tag was" : "tags were", pictures,
                                pictures == 1 ? "picture" : "pictures"),
            .next = "follow the tip, with the files of camera and collar",
            .command =
                "flextip track PICTURES --camera camera.yaml --collar collar.yaml -o "
                "RESULT-tracked"};
  if (Number(summary, "tags") > 0) return head;
  head.grade = kNotFound;
  head.says = pictures == 1 ? "No tag was found in the picture."
                            : fmt::format("No tag was found in {} pictures.", pictures);
  const std::string other =
      summary.value("family", "tag36h11") == "tag36h11" ? "tag25h9" : "tag36h11";
  head.next = "try another family: tag36h11, tag25h9, tag16h5 are common";
  head.command = fmt::format("flextip detect PICTURE --family {0} -o RESULT-{0}", other);
  return head;
}

/// The largest tolerable errors, where the scenario asks for them.
std::string ToleranceText(const Json& summary) {
  for (const auto& slice : summary.value("tolerance", Json::array())) {
    if (!Has(slice, "scale")) continue;
    return fmt::format(
        "The stated errors may be {:.2g} times as large everywhere in the part asked "
        "for.",
        Number(slice, "scale"));
  }
  return "";
}

Head MapLead(const Json& summary) {
  const Json slices = summary.value("slices", Json::array());
  double area_cm2 = 0.0, norm = 0.0, angle_deg = 0.0;
  for (const auto& slice : slices) {
    area_cm2 += Number(slice, "area_cm2");
    norm = std::max(norm, Number(slice, "largest_norm_G"));
    angle_deg = std::max(angle_deg, Number(slice, "largest_angle_deg"));
  }
  constexpr double kRounding = 1e-9;
  Head head{.grade = kGood,
            .says = ToleranceText(summary),
            .next = "take the maps into a paper",
            .command = kPictures};
  const std::string area = fmt::format("{:.4g} cm² of the plane{} can be reached", area_cm2,
                                       slices.size() == 1 ? "" : "s");
  if (norm > kRounding) {
    head.says = fmt::format("A step of the tip may go up to {:.3g}° astray.", angle_deg);
    head.more =
        fmt::format("The largest error that a step leaves is {:.3g} times the error before it; {}.",
                    norm, area);
  } else if (head.says.empty() && area_cm2 > 0.0) {
    head.says = "The controller's data are right: every step goes where it should.";
    head.more = area + ".";
  }
  if (norm >= 1.0) {
    head.grade = kBeware;
    head.reasons.emplace_back(
        "in places a step makes the error larger: a controller may not converge there");
  }
  return head;
}

/// The streams by name, and how much of them was assumed.
Head ImportLead(const Json& summary) {
  const auto streams = StreamNames(summary, "name");
  std::string names;
  for (const auto& name : streams) names += (names.empty() ? "" : ", ") + name;
  if (names.empty()) return {};
  const std::size_t assumed = summary.value("assumed", Json::array()).size();
  const std::size_t found = summary.value("findings", Json::array()).size();
  Head head{.grade = kGood,
            .says = fmt::format("{} {} imported: {}", streams.size(),
                                streams.size() == 1 ? "stream was" : "streams were", names),
            .more = assumed == 0
                        ? "Nothing was assumed."
                        : fmt::format("{} {} assumed (below): read them before you trust a result.",
                                      assumed, assumed == 1 ? "value was" : "values were")};
  SayUse(streams, "RESULT", head);
  if (found > 0) {
    head.grade = kBeware;
    head.says += fmt::format("; {} {} not fit", found, found == 1 ? "thing does" : "things do");
    head.next = "mend it with the options below, and import again; the check tells whether it fits";
    head.command = "flextip check RESULT -o RESULT-check";
  }
  head.says += ".";
  return head;
}

Head ReproduceLead(const Json& summary) {
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
  Head head{.grade = agree == compared ? kGood : kBeware,
            .says = more + ".",
            .next = "take the figures into a paper",
            .command = kPictures};
  if (compared > 0.0) {
    head.says =
        fmt::format("{:.0f} of {:.0f} of the thesis's numbers agree to 5 %.", agree, compared);
    head.more = more + "; where a number differs, its row says why.";
  }
  if (summary["chapters"].size() == 1) {
    head.next = "do the other chapters again, too";
    head.command = "flextip reproduce all -o RESULT-all";
  }
  return head;
}

/// The summary's inputs and output in the command; no command where the summary lacks them.
std::string Filled(const std::string& command, const Json& summary) {
  const Json inputs = summary.value("inputs", Json::array());
  const std::string input = inputs.empty() ? "" : inputs[0].get<std::string>();
  const std::string output = summary.value("output", "");
  if (output.empty()) return "";
  if (input.empty() && command.find(" RECORDING") != std::string::npos) return "";
  const auto folder = std::filesystem::path(input).parent_path();
  return FillPlaceholders(command, {{"RECORDING", input},
                                    {"PICTURE", input},
                                    {"PICTURES", folder.empty() ? "." : folder.string()},
                                    {"RESULT", output}});
}

Head LeadFor(const std::string& command, const Json& summary, const std::filesystem::path& folder) {
  if (command == "simulate") return SimulateLead(folder);
  if (command == "control") return ControlLead(folder);
  if (command == "excerpt") return ExcerptLead(summary);
  if (command == "check") return CheckLead(summary);
  if (command == "shape") return ShapeLead(summary, folder);
  if (command == "detect") return DetectLead(summary);
  if (command == "map") return MapLead(summary);
  if (command.starts_with("import ")) return ImportLead(summary);
  if (command == "reproduce") return ReproduceLead(summary);
  return {};
}

}  // namespace

Head LeadOf(const std::filesystem::path& folder) {
  const auto file = folder / "summary.json";
  const Json summary = Json::parse(ReadBytes(file), nullptr, false);
  if (!summary.is_object()) throw InputError::At(file.string(), 0, "not an object");
  const std::string command =
      summary.contains("command") && summary["command"].is_string() ? summary["command"] : "";
  Head head = LeadFor(command, summary, folder);
  head.command = Filled(head.command, summary);
  return head;
}

}  // namespace flextip::report::leads
