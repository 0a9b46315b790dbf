// The page of flextip check: what was found, each with its mend, and the streams.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

using Summary = nlohmann::ordered_json;

std::string FindingItem(const Summary& finding) {
  std::string html = fmt::format(
      "<li><b>{}</b>: {} <code>{}</code>", EscapeHtml(finding.value("severity", "doubtful")),
      EscapeHtml(finding.value("text", "")), EscapeHtml(finding.value("finding", "")));
  const std::string mend = finding.value("mend", "");
  if (!mend.empty()) html += "<br>Mend: " + EscapeHtml(mend);
  return html + "</li>\n";
}

void AddWhatWasFound(Report& report, const Summary& findings) {
  if (findings.empty()) return;
  std::string html = "<aside class=\"warnings\"><h3>What was found</h3>\n<ul>\n";
  for (const auto& finding : findings) html += FindingItem(finding);
  report.AddHtml(html + "</ul></aside>\n");
}

std::string Number(const Summary& stream, const char* key, const char* unit, double factor = 1.0) {
  return fmt::format("{:.4g}{}", factor * stream.value(key, 0.0), unit);
}

void AddStreams(Report& report, const Summary& streams) {
  Table table{.title = "Streams",
              .header = {"stream", "samples", "duration", "rate", "stated rate", "largest gap",
                         "covered by wrist0", "first at"}};
  for (const auto& s : streams) {
    const double stated_hz = s.value("stated_rate_hz", 0.0);
    table.rows.push_back({s.value("stream", ""), Number(s, "samples", ""),
                          Number(s, "duration_s", " s"), Number(s, "median_rate_hz", " Hz"),
                          stated_hz > 0.0 ? Number(s, "stated_rate_hz", " Hz") : "–",
                          Number(s, "largest_gap_s", " s"),
                          Number(s, "overlap_with_wrist", " %", 100.0),
                          s.value("first_ns", "") + " ns"});
  }
  if (!table.rows.empty()) report.AddTable(table);
}

}  // namespace

void WriteCheckReport(const std::filesystem::path& folder) {
  Report report = TitledPage(folder, "Check of a recording");
  const Summary summary = Summary::parse(ReadBytes(folder / "summary.json"));
  report.AddHtml(HeadHtml(HeadOf(folder)));
  AddWhatWasFound(report, summary.value("findings", Summary::array()));
  report.AddWarnings(WarningsNotSaid(folder));
  AddStreams(report, summary.value("streams", Summary::array()));
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
