// Pages whose pictures come from figures.json.
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/page_parts.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

void AddTableFile(Report& report, const fs::path& file, const std::string& title) {
  if (!fs::exists(file)) return;
  const auto table = ReadResultTable(file);
  Table out{.title = title, .header = table.names};
  for (std::size_t r = 0; r < table.Rows(); ++r) {
    std::vector<std::string> row;
    for (const auto& column : table.texts) row.push_back(column[r]);
    out.rows.push_back(std::move(row));
  }
  report.AddTable(out);
}

void AddFigureFile(Report& report, const fs::path& file) {
  const auto figures = nlohmann::json::parse(ReadBytes(file), nullptr, false);
  if (!figures.is_array()) throw InputError::At(file.string(), 0, "is not a list of figures");
  for (const auto& figure : figures) {
    if (!figure.is_object()) throw InputError::At(file.string(), 0, "holds what is no figure");
    report.AddFigure(figure.value("title", ""), figure.value("caption", ""), figure.dump());
  }
}

}  // namespace

void WriteReproduceReport(const fs::path& folder) {
  Report report = BeginPage(folder, "The thesis, done again");
  AddTableFile(report, folder / "table.csv", "Numbers: the thesis's and ours");
  if (fs::exists(folder / "figures.json")) AddFigureFile(report, folder / "figures.json");
  report.Write(folder / "report.html");
}

void WriteMapReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Motion errors across the workspace");
  AddFigureFile(report, folder / "figures.json");
  AddTableFile(report, folder / "table.csv", "Numbers");
  report.Write(folder / "report.html");
}

}  // namespace flextip
