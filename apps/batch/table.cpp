#include "apps/batch/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/common/judgement.h"
#include "apps/common/run_facts.h"
#include "batch/records.h"
#include "core/version.h"
#include "recording/text/csv.h"
#include "report/batch/spread.h"
#include "report/compare/summary_values.h"
#include "report/pages.h"
#include "report/result_files.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using batch::Outcome;
using batch::Status;
using Json = nlohmann::ordered_json;

struct Row {
  const ListedItem* item = nullptr;
  const Outcome* end = nullptr;
  std::string message;
  std::vector<report::SummaryValue> values;
  Json times;
};

/// In the order of their first row.
class Columns {
 public:
  void Add(const std::string& name) {
    if (places_.emplace(name, names_.size()).second) names_.push_back(name);
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::map<std::string, std::size_t> places_;
  std::vector<std::string> names_;
};

std::string OneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

/// 128 and the signal where one ended the item.
int CodeInAShell(const Outcome& end) { return end.signal != 0 ? 128 + end.signal : end.exit_code; }

std::vector<Row> RowsOf(const BatchPlan& plan, BatchFolder& folder) {
  std::vector<Row> rows;
  for (const ListedItem& item : plan.items) {
    const Outcome* end = folder.records().Find(item.name);
    if (!end) continue;
    Row row{&item, end, "", {}, Json::object()};
    const Json payload = Json::parse(end->payload, nullptr, false);
    if (payload.is_object()) {
      row.message = payload.value("message", "");
      row.times = payload.value("times", Json::object());
    }
    const fs::path result = ItemFolder(folder.out(), item.name);
    if (fs::exists(result / "summary.json")) row.values = report::ValuesOf(result);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string TableCsv(const std::vector<Row>& rows) {
  Columns values, times;
  for (const Row& row : rows) {
    for (const auto& value : row.values) values.Add(value.Path());
    for (const auto& [key, value] : row.times.items()) times.Add(key);
  }
  std::vector<std::string> columns{"name", "input", "exit_code", "status", "message"};
  columns.insert(columns.end(), values.names().begin(), values.names().end());
  columns.emplace_back("seconds");
  columns.insert(columns.end(), times.names().begin(), times.names().end());
  columns.emplace_back("host");
  CsvWriter csv(columns, false);
  for (const Row& row : rows) {
    csv.Add(row.item->name).Add(OneLine(row.item->input));
    csv.Add(std::to_string(CodeInAShell(*row.end))).Add(StatusText(*row.end));
    csv.Add(OneLine(row.message));
    std::map<std::string, std::string> texts;
    for (const auto& value : row.values) texts[value.Path()] = value.text;
    for (const std::string& name : values.names()) csv.Add(OneLine(texts[name]));
    csv.AddFixed(row.end->seconds, 3);
    for (const std::string& name : times.names()) {
      csv.Add(row.times.contains(name) ? row.times[name].dump() : "");
    }
    csv.Add(row.end->host);
    csv.EndRow();
  }
  return csv.text();
}

std::string Counted(std::size_t count, const char* one, const char* several) {
  return fmt::format("{} {}", count, count == 1 ? one : several);
}

Judgement JudgementOf(const std::vector<Row>& rows, const std::string& command) {
  constexpr std::size_t kMostReasons = 5;
  std::map<std::string, std::size_t> grades;
  std::vector<const Row*> failed;
  for (const Row& row : rows) {
    if (row.end->status != Status::kOk) failed.push_back(&row);
    for (const auto& value : row.values) {
      if (value.Path() == "grade") ++grades[value.text];
    }
  }
  Judgement judged;
  const std::size_t ok = rows.size() - failed.size();
  judged.says = failed.empty()
                    ? fmt::format("{} of {} ran through.", Counted(ok, "item", "items"), command)
                    : fmt::format("{} of {} items of {} ran through, {} did not.", ok, rows.size(),
                                  command, failed.size());
  if (ok == 0) judged.grade = Grade::kNotFound;
  for (std::size_t i = 0; i < failed.size(); ++i) {
    if (i == kMostReasons) {
      judged.Mention(fmt::format("and {} more", failed.size() - i), ok > 0);
      break;
    }
    const Row& row = *failed[i];
    judged.Mention(fmt::format("{}: {}{}", row.item->name, StatusText(*row.end),
                               row.message.empty() ? "" : ", " + row.message),
                   ok > 0);
  }
  if (const std::size_t n = grades[Name(Grade::kBeware)]; n > 0) {
    judged.Mention(fmt::format("{} to be used with care, as {} own page says",
                               Counted(n, "answer is", "answers are"), n == 1 ? "its" : "their"),
                   true);
  }
  return judged;
}

}  // namespace

std::size_t WriteBatchResults(const BatchPlan& plan, BatchFolder& folder, const std::string& list) {
  const fs::path& out = folder.out();
  const std::vector<Row> rows = RowsOf(plan, folder);
  batch::WriteWhole(out / "table.csv", TableCsv(rows));
  const std::string command = fmt::format("{}", fmt::join(plan.command, " "));
  report::WriteFigures(out / "figures.json.new", report::SpreadOf(out / "table.csv", command));
  fs::rename(out / "figures.json.new", out / "figures.json");
  std::map<Status, std::size_t> count;
  double seconds = 0.0;
  for (const Row& row : rows) {
    ++count[row.end->status];
    seconds += row.end->seconds;
  }
  const Json summary = {{"verdict", JudgementJson(JudgementOf(rows, command))},
                        {"of", command},
                        {"items", rows.size()},
                        {"ok", count[Status::kOk]},
                        {"failed", count[Status::kFailed]},
                        {"crashed", count[Status::kCrashed]},
                        {"timed_out", count[Status::kTimedOut]},
                        {"command", "batch"},
                        {"version", kVersion},
                        {"seconds", seconds},
                        {"date", folder.date()},
                        {"typed", Typed()},
                        {"inputs", Json::array({list})},
                        {"output", out.string()},
                        {"warnings", Json::array()}};
  batch::WriteWhole(out / "summary.json",
                    summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  report::WriteBatchReport(out);
  return rows.size() - count[Status::kOk];
}

}  // namespace flextip
