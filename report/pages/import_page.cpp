// The page of flextip import: what was assumed, and every stream over time, thinned as it is read.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "report/pages.h"
#include "report/result_files.h"
#include "report/stream_figures.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string TextAt(const Json& json, const char* key) {
  if (!json.contains(key)) return "";
  return json[key].is_string() ? json[key].get<std::string>() : json[key].dump();
}

void AddStreamTable(Report& report, const Json& summary) {
  Table table;
  table.title = "Streams, as they were read back";
  table.header = {"stream",   "samples",     "time",    "rate",
                  "first at", "first value", "read as", "left out"};
  for (const Json& stream : summary.value("streams", Json::array())) {
    table.rows.push_back({TextAt(stream, "name"), TextAt(stream, "samples"),
                          fmt::format("{:.6g} s", stream.value("seconds", 0.0)),
                          fmt::format("{:.4g} Hz", stream.value("rate_hz", 0.0)),
                          fmt::format("{:.3f} s", 1e-9 * stream.value("first_time_ns", 0.0)),
                          TextAt(stream, "first_value"), TextAt(stream, "units"),
                          TextAt(stream, "skipped")});
  }
  report.AddTable(table);
}

void AddAssumed(Report& report, const Json& summary) {
  Table table;
  table.title = "Assumed: neither the files nor the options say so";
  table.header = {"item", "taken as"};
  for (const Json& item : summary.value("assumed", Json::array())) {
    table.rows.push_back({TextAt(item, "name"), TextAt(item, "is")});
  }
  if (!table.rows.empty()) report.AddTable(table);
}

}  // namespace

void WriteImportReport(const fs::path& folder) {
  const Json summary = Json::parse(ReadBytes(folder / "summary.json"));
  Report report = TitledPage(folder, "Imported recording");
  report.AddHtml(HeadHtml(HeadOf(folder)));
  AddFindings(report, folder);
  report.AddWarnings(WarningsNotSaid(folder));
  AddStreamTable(report, summary);
  AddAssumed(report, summary);
  report.AddHeading("Streams over time");
  for (const Json& stream : summary.value("streams", Json::array())) {
    const std::string name = TextAt(stream, "name");
    if (name.starts_with("cam") || !fs::exists(folder / name / "data.csv")) continue;
    report.AddFigures(StreamFigures(folder / name));
  }
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
