// flextip compare: results of several runs of one command on one page.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/compare/comparison.h"
#include "report/labels.h"
#include "report/pages.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  std::vector<fs::path> results;
  fs::path out;
  bool force = false;
};

std::string KeyOf(const report::ComparedNumber& number) {
  return number.group.empty() ? number.key : number.group + "/" + number.key;
}

/// A row a number: its key, the value of each run, the run with the best.
std::string TableCsv(const report::Comparison& comparison) {
  std::vector<std::string> columns{"key"};
  columns.insert(columns.end(), comparison.names.begin(), comparison.names.end());
  columns.emplace_back("best");
  CsvWriter csv(columns);
  for (const auto& number : comparison.numbers) {
    csv.Add(KeyOf(number));
    for (const auto& value : number.values) {
      if (value) {
        csv.Add(*value);
      } else {
        csv.AddEmpty();
      }
    }
    const auto best = number.Best();
    csv.Add(best ? comparison.names[*best] : std::string());
    csv.EndRow();
  }
  return csv.TakeText();
}

/// The same in words, for the page.
nlohmann::ordered_json NumbersJson(const report::Comparison& comparison) {
  auto rows = nlohmann::ordered_json::array();
  for (const auto& number : comparison.numbers) {
    nlohmann::ordered_json row;
    const std::string label = report::Label(number.key, comparison.command);
    row["number"] = number.group.empty() ? label : number.group + ", " + label;
    for (std::size_t i = 0; i < comparison.names.size(); ++i) {
      const auto& value = number.values[i];
      row[comparison.names[i]] = value ? report::SpokenValue(number.key, *value) : "";
    }
    const auto best = number.Best();
    row["best"] = best ? comparison.names[*best] : "";
    rows.push_back(std::move(row));
  }
  return rows;
}

void RunCompare(const CompareOptions& options, bool quiet) {
  OutputFolder output(options.out, "compare", {.force = options.force, .inputs = options.results});
  const report::Comparison comparison = report::CompareResults(options.results);
  WriteTextFile(output.folder() / "table.csv", TableCsv(comparison));
  report::WriteFigures(output.folder() / "figures.json", comparison.figures);
  Judgement judged;
  judged.says = comparison.says;
  judged.next = "take the figures into a paper";
  judged.command = "flextip export pictures RESULT --format pdf -o RESULT-pictures";
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < comparison.names.size(); ++i) {
    runs.push_back({{"run", comparison.names[i]},
                    {"answer", comparison.answers[i]},
                    {"folder", comparison.folders[i].string()}});
  }
  output.WriteSummary(
      {{"verdict", JudgementJson(judged)}, {"runs", runs}, {"numbers", NumbersJson(comparison)}});
  report::WriteCompareReport(output.folder());
  output.Commit();
  PrintJudgement(judged, output.paths(), quiet);
  if (!quiet) fmt::print("{}\n", (options.out / "report.html").string());
}

}  // namespace

void AddCompare(CLI::App& app, AppContext& context) {
  auto* command =
      app.add_subcommand("compare", "Results of several runs of a command, side by side");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("results", options->results, "Folders that runs of one command wrote (-o)")
      ->required()
      ->expected(2, 20)
      ->type_name("RESULT");
  command->add_option("-o,--output", options->out, "Folder for the page")
      ->required()
      ->type_name("OUT");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example (before and after a calibration):\n"
      "  flextip compare track track-calibrated -o comparison\n");
  OnRun(*command, context, [options, &context] { RunCompare(*options, context.quiet); });
}

}  // namespace flextip
