// flextip-reproduce, started by flextip reproduce: the thesis's simulations and experiments, its
// numbers beside this program's.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/exit_code.h"
#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/common/run_facts.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/figure.h"
#include "report/leads/leads.h"
#include "report/pages.h"
#include "reproduction/chapter.h"

namespace flextip::reproduction {
namespace {

struct Options {
  std::string chapters;
  std::filesystem::path out;
  bool force = false;
  bool quiet = false;
  ReproduceOptions work;
};

struct Chapter {
  const char* name;
  ChapterResult (*run)(const ReproduceOptions&, const ChapterProgress&);
};
constexpr Chapter kChapters[] = {{"2", ReproduceChapter2},
                                 {"3", ReproduceChapter3},
                                 {"4", ReproduceChapter4},
                                 {"5", ReproduceChapter5}};

std::string Rounded(const std::optional<double>& number) {
  return number ? fmt::format("{:.6g}", *number) : "";
}

std::string TableText(const std::vector<TableRow>& rows) {
  CsvWriter csv({"quantity", "thesis", "flextip", "unit", "note"}, false);
  for (const auto& row : rows) {
    csv.Add(row.quantity).Add(Rounded(row.thesis)).Add(Rounded(row.flextip));
    csv.Add(row.unit).Add(row.note).EndRow();
  }
  return csv.text();
}

ChapterResult RunChapter(const Chapter& chapter, const ReproduceOptions& options, bool quiet) {
  constexpr double kSteps = 1000.0;
  Progress progress(fmt::format("chapter {}", chapter.name), std::size_t(kSteps), quiet);
  return chapter.run(options, [&](double done) { progress.Update(std::size_t(done * kSteps)); });
}

void PrintRows(const std::vector<TableRow>& rows) {
  fmt::print("{:>12} {:>12} {:<6} {}\n", "thesis", "flextip", "unit", "quantity");
  for (const auto& row : rows)
    fmt::print("{:>12} {:>12} {:<6} {}\n", Rounded(row.thesis), Rounded(row.flextip), row.unit,
               row.quantity);
}

bool IsCompared(const TableRow& row) { return row.thesis && row.flextip; }

/// Agreement as the page's first sentence counts it: to a twentieth of the thesis's number.
bool Agrees(const TableRow& row) {
  constexpr double kShare = 0.05;
  return IsCompared(row) && std::abs(*row.flextip - *row.thesis) <= kShare * std::abs(*row.thesis);
}

void RunReproduce(const Options& options) {
  OutputFolder output(options.out, "reproduce", {.force = options.force});
  ChapterResult all;
  nlohmann::json chapters = nlohmann::json::array();
  for (const auto& chapter : kChapters) {
    if (options.chapters != "all" && options.chapters != chapter.name) continue;
    const auto start = std::chrono::steady_clock::now();
    ChapterResult result = RunChapter(chapter, options.work, options.quiet);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    chapters.push_back({{"chapter", chapter.name},
                        {"seconds", seconds.count()},
                        {"numbers", result.rows.size()},
                        {"compared", std::ranges::count_if(result.rows, IsCompared)},
                        {"agree", std::ranges::count_if(result.rows, Agrees)},
                        {"figures", result.figures.size()}});
    std::move(result.rows.begin(), result.rows.end(), std::back_inserter(all.rows));
    std::move(result.figures.begin(), result.figures.end(), std::back_inserter(all.figures));
  }
  if (options.work.quick) output.Warn("a quick run: coarse grids, few repetitions");
  WriteTextFile(output.folder() / "table.csv", TableText(all.rows));
  report::WriteFigures(output.folder() / "figures.json", all.figures);
  output.WriteSummary({{"chapters", chapters}});
  report::WriteReproduceReport(output.folder());
  output.Commit();
  if (options.quiet) return;
  PrintRows(all.rows);
  const report::Head head = report::leads::LeadOf(output.folder());
  PrintNext(head.next, head.command);
  fmt::print("{}\n", (output.name() / "report.html").string());
}

void AddOptions(CLI::App& app, Options& options) {
  app.add_option("chapters", options.chapters, "2, 3, 4, 5 or all")
      ->required()
      ->check(CLI::IsMember({"2", "3", "4", "5", "all"}));
  app.add_option("-o,--output", options.out, "Folder for the results")->required();
  app.add_option("--seed", options.work.seed, "Of every random draw (1)");
  app.add_flag("--quick", options.work.quick, "Coarse and short: to see what there is");
  app.add_flag("--force", options.force, "Replace the folder of an earlier run");
  app.add_flag("-q,--quiet", options.quiet, "No progress bar and no remarks, only errors");
  app.footer("Example:\n  flextip reproduce 2 -o chapter2\n");
}

int Run(int argc, char** argv) {
  NoteTyped("flextip reproduce", {argv + 1, argv + argc});
  CLI::App app("The thesis's figures and numbers beside ours", "flextip reproduce");
  Options options;
  AddOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {  // --help
    return app.exit(done);
  } catch (const CLI::ParseError& e) {
    return Complain(fmt::format("{} (see flextip reproduce --help)", e.what()), kBadUsage);
  }
  RunReproduce(options);
  return kDone;
}

}  // namespace
}  // namespace flextip::reproduction

int main(int argc, char** argv) {
  return flextip::ExitCodeOf([&] { return flextip::reproduction::Run(argc, argv); });
}
