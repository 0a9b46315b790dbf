#include "report/diagnose/recordings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/diagnose/parts.h"
#include "report/diagnose/words.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kShown = 0.05;        // an effect as likely as that in some recording has a row
constexpr std::size_t kOpenRows = 12;  // a longer table is folded

void AddShort(Report& report, const Table& table) {
  if (table.rows.size() <= kOpenRows) return report.AddTable(table);
  report.AddHtml(FoldedTableHtml(table.title, table.header, table.rows));
}

/// A row a recording, a column an effect.
Table PresenceTable(const Json& diagnosis) {
  Table table{.title = "Effects by recording", .header = {"recording"}};
  const Json presence = diagnosis.value("presence_in", Json::object());
  std::vector<std::string> shown;
  for (const auto& [effect, by_recording] : presence.items()) {
    const auto values = by_recording.get<std::vector<double>>();
    if (values.empty() || *std::max_element(values.begin(), values.end()) < kShown) continue;
    shown.push_back(effect);
    table.header.push_back(SpokenHypothesis(effect));
  }
  std::size_t r = 0;
  for (const auto& name : diagnosis["recordings"]) {
    table.rows.push_back({name.get<std::string>()});
    for (const std::string& effect : shown)
      table.rows.back().push_back(Percent(presence[effect][r].get<double>()));
    ++r;
  }
  if (shown.empty()) table.caption = "No effect is likely in any of them.";
  return table;
}

/// "offset 1.20 ± 0.05 mm, ...".
std::string ParametersText(const Json& parameters) {
  std::string text;
  for (const auto& [name, parameter] : parameters.items()) {
    const ShownUnit unit = ShownUnitOf(name);
    const Json &value = parameter.at("value"), &sd = parameter.at("sd");
    const auto number = [&](const Json& numbers, std::size_t i) {
      const Json& one = numbers.is_array() ? numbers.at(i) : numbers;
      return unit.per_si * one.get<double>();
    };
    std::string list;
    for (std::size_t i = 0; i < (value.is_array() ? value.size() : 1); ++i)
      list += (i == 0 ? "" : ", ") + WithDeviation(number(value, i), number(sd, i), unit.unit);
    text += (text.empty() ? "" : "; ") + unit.name + " " + list;
  }
  return text;
}

Table ChangeTable(const Json& diagnosis) {
  Table table{.title = "What began", .header = {"effect", "first in", "probability", "parameters"}};
  for (const auto& change : diagnosis.value("changes", Json::array())) {
    table.rows.push_back({SpokenHypothesis(change.at("effect").get<std::string>()),
                          change.at("first_in").get<std::string>(),
                          Percent(change.at("probability").get<double>()),
                          ParametersText(change.at("parameters"))});
  }
  return table;
}

/// A number of a round.
std::string Number(const Json& round, const char* key, const char* format) {
  return fmt::format(fmt::runtime(format), round.at(key).get<double>());
}

}  // namespace

void AddRounds(Report& report, const std::filesystem::path& folder) {
  const Json summary = Json::parse(ReadBytes(folder / "summary.json"));
  if (!summary.contains("rounds")) return;
  Table table{
      .title = "Motions, and what was known after each",
      .caption = fmt::format("{} s of motion; {}.", Number(summary, "seconds_of_motion", "{:.1f}"),
                             summary.at("end").get<std::string>()),
      .header = {"recording", "seconds", "weight at the tip (N)", "answer", "probability",
                 "the next motion"}};
  for (const auto& round : summary.at("rounds")) {
    table.rows.push_back(
        {round.at("recording").get<std::string>(), Number(round, "seconds", "{:.1f}"),
         Number(round, "hung_weight_N", "{:.2g}"),
         SpokenHypothesis(round.at("answer").get<std::string>()),
         Percent(round.at("probability").get<double>()), round.at("next").get<std::string>()});
  }
  report.AddTable(table);
}

std::string WhatBegan(const std::filesystem::path& folder) {
  const Json diagnosis = Json::parse(ReadBytes(folder / "diagnosis.json"));
  std::string began;
  for (const auto& change : diagnosis.value("changes", Json::array())) {
    began += fmt::format(
        "{} began in {} ({}). ", SpokenHypothesis(change.at("effect").get<std::string>()),
        change.at("first_in").get<std::string>(), Percent(change.at("probability").get<double>()));
  }
  if (began.empty()) return began;
  began[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(began[0])));
  return began + "Before that: ";
}

void AddRecordings(Report& report, const std::filesystem::path& folder) {
  const Json diagnosis = Json::parse(ReadBytes(folder / "diagnosis.json"));
  if (!diagnosis.contains("recordings")) return;
  report.AddHeading("Recording by recording");
  const Table changes = ChangeTable(diagnosis);
  if (!changes.rows.empty()) report.AddTable(changes);
  AddShort(report, PresenceTable(diagnosis));
}

}  // namespace flextip::report
