// The page of flextip batch: what did not run through, how the numbers spread, every item.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "report/batch/spread.h"
#include "report/labels.h"
#include "report/pages.h"
#include "report/report.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRows = 2000;  // the page must still open
constexpr const char* kItsLine = "its line";
constexpr std::size_t kMostNumbers = 10;  // columns of numbers

const std::string& Cell(const ResultTable& table, const std::string& column, std::size_t row) {
  static const std::string kNone;
  const auto* texts = table.Texts(column);
  return texts ? (*texts)[row] : kNone;
}

std::string Td(const std::string& html, double order = std::nan("")) {
  if (!std::isfinite(order)) return fmt::format("<td>{}</td>", html);
  return fmt::format("<td data-order=\"{}\">{}</td>", order, html);
}

std::string Link(const std::string& to, const std::string& text) {
  return fmt::format("<a href=\"{}\">{}</a>", EscapeHtml(to), EscapeHtml(text));
}

/// An item's page, or what it said where it has none.
std::string LinkedName(const fs::path& folder, const std::string& name) {
  for (const std::string& file : {"items/" + name + "/report.html", "logs/" + name + ".log"}) {
    if (fs::exists(folder / file)) return Link(file, name);
  }
  return EscapeHtml(name);
}

std::string Head(const std::vector<std::string>& columns) {
  std::string html = "<figure class=\"table\"><table class=\"sortable\">\n<thead><tr>";
  for (const std::string& column : columns) {
    const bool words = column == kItsLine || column == "answer";
    html += fmt::format("<th{}>{}</th>", words ? " class=\"words\"" : "", EscapeHtml(column));
  }
  return html + "</tr></thead>\n<tbody>\n";
}

std::string FailedHtml(const fs::path& folder, const ResultTable& table,
                       const std::vector<std::size_t>& rows) {
  std::string html = Head({"item", "end", "exit code", kItsLine, "messages"});
  for (const std::size_t row : rows) {
    const std::string name = Cell(table, "name", row), log = "logs/" + name + ".log";
    html += "<tr>" + Td(LinkedName(folder, name)) + Td(EscapeHtml(Cell(table, "status", row))) +
            Td(EscapeHtml(Cell(table, "exit_code", row))) + "<td class=\"words\">" +
            EscapeHtml(Cell(table, "message", row)) + "</td>" +
            Td(fs::exists(folder / log) ? Link(log, "log") : "") + "</tr>\n";
  }
  return html + "</tbody></table></figure>\n";
}

std::string ItemsHtml(const fs::path& folder, const ResultTable& table,
                      const std::vector<std::size_t>& rows, const std::string& command) {
  std::vector<std::string> numbers = SpreadColumns(folder / "table.csv", command);
  if (numbers.size() > kMostNumbers) {
    numbers.resize(kMostNumbers - 1);
    numbers.emplace_back("seconds");
  }
  std::vector<std::string> words;
  for (const char* column : {"status", "grade", "answer"}) {
    if (table.Texts(column)) words.emplace_back(column);
  }
  std::vector<std::string> head{"item"};
  head.insert(head.end(), words.begin(), words.end());
  for (const std::string& column : numbers) {
    const std::size_t slash = column.rfind('/');
    const std::string label = Label(column.substr(slash + 1), command);  // npos + 1 is 0
    head.push_back(slash == std::string::npos ? label : column.substr(0, slash) + ", " + label);
  }
  std::string html = Head(head);
  for (const std::size_t row : rows) {
    html += "<tr>" + Td(LinkedName(folder, Cell(table, "name", row)));
    for (const std::string& column : words) {
      const std::string& text = Cell(table, column, row);
      html += column == "answer" ? "<td class=\"words\">" + EscapeHtml(text) + "</td>"
                                 : Td(EscapeHtml(text));
    }
    for (const std::string& column : numbers) {
      const double value = NumberIn(Cell(table, column, row));
      html += std::isfinite(value)
                  ? Td(EscapeHtml(SpokenValue(column.substr(column.rfind('/') + 1), value)), value)
                  : Td("");
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></figure>\n";
}

}  // namespace

void WriteBatchReport(const fs::path& folder) {
  const ResultTable table = ReadResultTable(folder / "table.csv");
  const auto summary = nlohmann::json::parse(ReadBytes(folder / "summary.json"), nullptr, false);
  const std::string command = summary.value("of", "");
  Report report = BeginPage(folder, "Batch of " + command);
  std::vector<std::size_t> rows(table.Rows()), failed;
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(failed),
               [&](std::size_t row) { return Cell(table, "status", row) != "ok"; });
  if (failed.size() > kMostRows) failed.resize(kMostRows);
  if (!failed.empty()) {
    report.AddHeading("Items that did not run through");
    report.AddHtml(FailedHtml(folder, table, failed));
  }
  report.AddHeading("Items");
  if (rows.size() > kMostRows) {
    report.AddHtml(fmt::format("<p>The first {} of {} items; table.csv has all.</p>\n", kMostRows,
                               rows.size()));
    rows.resize(kMostRows);
  }
  report.AddHtml(ItemsHtml(folder, table, rows, command));
  report.AddFigureFile(folder / "figures.json", "Spread");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
