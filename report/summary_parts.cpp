#include "report/summary_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/error.h"
#include "report/diagnose/parts.h"
#include "report/labels.h"
#include "report/leads/leads.h"
#include "report/page_end.h"
#include "report/result_files.h"
#include "report/verdict.h"

namespace flextip::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kOpenRows = 15;  // a longer table is folded

Json ReadSummary(const std::filesystem::path& folder) {
  const auto path = folder / "summary.json";
  auto json = Json::parse(ReadBytes(path), nullptr, false);
  if (!json.is_object()) {
    throw InputError::At(path.string(), 0, "is damaged, expected the summary of a command");
  }
  return json;
}

/// A value as people read it; what is neither number nor text is shown as JSON.
std::string Shown(const std::string& key, const Json& value) {
  if (value.is_number()) return SpokenValue(key, value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  return value.is_null() ? "–" : value.dump();
}

bool IsScalar(const Json& value) { return value.is_number() || value.is_boolean(); }

std::string TextOf(const Json& summary, const char* key) {
  return summary.contains(key) ? Shown(key, summary[key]) : std::string();
}

/// A list or a map whose items are all maps is a table: their keys are its columns.
bool IsTable(const Json& value) {
  return value.is_structured() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_object(); });
}

/// Findings are the result of a check; elsewhere they have a box of their own.
bool IsShownAsTable(const Json& summary, const std::string& key) {
  const bool in_a_box = key == "findings" && TextOf(summary, "command") != "check";
  const bool has_pictures = key == "stops";
  return key != "warnings" && key != "verdict" && !has_pictures && !in_a_box &&
         IsTable(summary[key]);
}

std::vector<std::string> ColumnKeys(const Json& items) {
  std::vector<std::string> keys;
  for (const auto& item : items) {
    for (const auto& [key, value] : item.items()) {
      if (value.is_structured()) continue;
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

// JSON's keys are in the alphabet's order: what a row is about goes first, words last.
void PutNameFirst(std::vector<std::string>& keys) {
  const auto rank = [](const std::string& key) {
    static const std::vector<std::string> names = {
        "view",  "image", "left", "right",   "part",       "lens",    "motion", "parameter",
        "field", "hold",  "pose", "seconds", "distance_m", "finding", "stream"};
    static const std::vector<std::string> words = {"reason", "left_reason", "right_reason",
                                                   "text",   "mend",        "best"};
    if (std::find(names.begin(), names.end(), key) != names.end()) return 0;
    return std::find(words.begin(), words.end(), key) != words.end() ? 2 : 1;
  };
  std::stable_sort(keys.begin(), keys.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
}

// Without its unit, which is in every cell, unless another column is called the same.
std::string ColumnTitle(const std::string& key, const std::vector<std::string>& keys) {
  if (key == "seconds") return "time";
  const std::string title = Label(key);
  const auto alike = std::count_if(keys.begin(), keys.end(),
                                   [&](const std::string& other) { return Label(other) == title; });
  if (alike < 2) return title;
  std::string full = key;
  std::replace(full.begin(), full.end(), '_', ' ');
  return full;
}

void AddJsonTable(Report& report, const std::string& name, const Json& items) {
  auto keys = ColumnKeys(items);
  PutNameFirst(keys);
  Table table;
  table.title = Label(name);
  if (items.is_object()) table.header.emplace_back("");
  const bool of_runs = name == "numbers";  // of compare: its columns are names of folders
  for (const auto& key : keys) table.header.push_back(of_runs ? key : ColumnTitle(key, keys));
  for (const auto& [label, item] : items.items()) {
    std::vector<std::string> row;
    if (items.is_object()) row.push_back(label);
    for (const auto& key : keys) row.push_back(item.contains(key) ? Shown(key, item[key]) : "–");
    table.rows.push_back(std::move(row));
  }
  if (table.rows.size() <= kOpenRows) return report.AddTable(table);
  report.AddHtml(FoldedTableHtml(fmt::format("{} ({})", table.title, table.rows.size()),
                                 table.header, table.rows));
}

}  // namespace

Report TitledPage(const std::filesystem::path& folder, const std::string& title) {
  const Json summary = ReadSummary(folder);
  Report report(title, "flextip " + TextOf(summary, "command"));
  report.SetEnd(PageEnd(folder));
  return report;
}

void AddFindings(Report& report, const std::filesystem::path& folder) {
  const Json summary = ReadSummary(folder);
  std::vector<std::pair<std::string, std::string>> findings;
  if (TextOf(summary, "command") == "check") return;  // its result, in a table
  for (const auto& f : summary.value("findings", Json::array()))
    findings.emplace_back(TextOf(f, "text"), TextOf(f, "mend"));
  report.AddBeware(findings);
}

Head HeadOf(const std::filesystem::path& folder) {
  const Head verdict = VerdictOf(folder);
  return verdict.says.empty() ? leads::LeadOf(folder) : verdict;
}

std::vector<std::string> WarningsNotSaid(const std::filesystem::path& folder) {
  const Json summary = ReadSummary(folder);
  const auto reasons = VerdictOf(folder).reasons;
  const Json verdict = summary.value("verdict", Json::object());
  const Json not_found = verdict.value("not_found", Json::array());
  std::vector<std::string> warnings;
  for (const auto& w : summary.value("warnings", Json::array())) {
    const std::string text = Shown("", w);
    bool said = std::find(reasons.begin(), reasons.end(), text) != reasons.end();
    for (const auto& one : not_found) {
      said = said || text.find(TextOf(one, "reason")) != std::string::npos;
    }
    if (!said) warnings.push_back(text);
  }
  return warnings;
}

std::string CommandOf(const std::filesystem::path& folder) {
  const std::string command = TextOf(ReadSummary(folder), "command");
  if (command.empty()) {
    throw InputError::At((folder / "summary.json").string(), 0, "states no command");
  }
  return command;
}

void AddSummaryNumbers(Report& report, const std::filesystem::path& folder) {
  const Json summary = ReadSummary(folder);
  const std::string command = TextOf(summary, "command");
  std::vector<std::string> keys;
  for (const auto& [key, value] : summary.items()) {
    const bool not_used = key == "streams_not_used" && value.is_string() &&
                          !value.get_ref<const std::string&>().empty();
    // How long it took stands at the end of the page.
    if ((IsScalar(value) && key != "seconds") || not_used) keys.push_back(key);
  }
  std::stable_sort(keys.begin(), keys.end(), [&](const std::string& a, const std::string& b) {
    return IsBefore(a, b, command);
  });
  std::vector<std::pair<std::string, std::string>> numbers;
  numbers.reserve(keys.size());
  for (const std::string& key : keys)
    numbers.emplace_back(Label(key, command), Shown(key, summary[key]));
  report.AddNumbers(numbers);
}

void AddSummaryTables(Report& report, const std::filesystem::path& folder) {
  const Json summary = ReadSummary(folder);
  for (const auto& [key, value] : summary.items()) {
    if (IsShownAsTable(summary, key)) AddJsonTable(report, key, value);
  }
}

Report BeginPage(const std::filesystem::path& folder, const std::string& title,
                 const std::function<void(Report&)>& after_head) {
  Report report = TitledPage(folder, title);
  const Json summary = ReadSummary(folder);
  report.AddHtml(HeadHtml(HeadOf(folder)));
  if (after_head) after_head(report);
  AddFindings(report, folder);
  AddSummaryNumbers(report, folder);
  report.AddWarnings(WarningsNotSaid(folder));
  const bool has_tables =
      std::any_of(summary.items().begin(), summary.items().end(),
                  [&](const auto& item) { return IsShownAsTable(summary, item.key()); });
  if (has_tables) report.AddHeading("Results");
  AddSummaryTables(report, folder);
  return report;
}

}  // namespace flextip::report
