// Pages whose pictures come from figures.json.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "report/diagnose/parts.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

/// A row's cells, every column of the table.
std::vector<std::string> RowOf(const ResultTable& table, std::size_t r) {
  std::vector<std::string> row;
  for (const auto& column : table.texts) row.push_back(column[r]);
  return row;
}

/// Rows that have a number to stand beside are shown, the others folded.
void AddNumbers(Report& report, const fs::path& file) {
  if (!fs::exists(file)) return;
  const auto table = ReadResultTable(file);
  const auto* thesis = table.Texts("thesis");
  std::vector<std::vector<std::string>> beside, others;
  for (std::size_t r = 0; r < table.Rows(); ++r)
    (thesis == nullptr || (*thesis)[r].empty() ? others : beside).push_back(RowOf(table, r));
  report.AddHtml("<div class=\"noted\">");
  if (!beside.empty())
    report.AddTable({.title = "What the thesis states", .header = table.names, .rows = beside});
  if (beside.empty()) {
    report.AddTable({.title = "Numbers", .header = table.names, .rows = others});
  } else if (!others.empty()) {
    report.AddHtml(
        FoldedTableHtml(fmt::format("{} more numbers", others.size()), table.names, others));
  }
  report.AddHtml("</div>\n");
}

}  // namespace

void WriteReproduceReport(const fs::path& folder) {
  Report report = BeginPage(folder, "The thesis, done again");
  AddNumbers(report, folder / "table.csv");
  if (fs::exists(folder / "figures.json")) report.AddFigureFile(folder / "figures.json");
  report.Write(folder / "report.html");
}

void WriteMapReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Motion errors across the workspace");
  report.AddFigureFile(folder / "figures.json");
  AddNumbers(report, folder / "table.csv");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
