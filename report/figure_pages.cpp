// Pages whose pictures come from figures.json.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "report/diagnose/parts.h"
#include "report/page_parts.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"

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

void AddFigureFile(Report& report, const fs::path& file) {
  const auto figures = nlohmann::json::parse(ReadBytes(file), nullptr, false);
  if (!figures.is_array()) throw InputError::At(file.string(), 0, "is not a list of figures");
  report.AddHtml("<div class=\"drawings\">\n");
  for (const auto& figure : figures) {
    if (!figure.is_object()) throw InputError::At(file.string(), 0, "holds what is no figure");
    report.AddFigure(figure.value("title", ""), figure.value("caption", ""), figure.dump());
  }
  report.AddHtml("</div>\n");
}

void WriteReproduceReport(const fs::path& folder) {
  Report report = BeginPage(folder, "The thesis, done again");
  AddNumbers(report, folder / "table.csv");
  if (fs::exists(folder / "figures.json")) AddFigureFile(report, folder / "figures.json");
  report.Write(folder / "report.html");
}

void WriteMapReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Motion errors across the workspace");
  AddFigureFile(report, folder / "figures.json");
  AddNumbers(report, folder / "table.csv");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
