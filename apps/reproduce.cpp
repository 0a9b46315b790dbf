// flextip reproduce: the thesis's simulations and experiments, its numbers beside this program's.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "recording/text/text.h"
#include "report/figure.h"
#include "report/pages.h"
#include "reproduction/chapter.h"

namespace flextip {
namespace {

struct Options {
  std::string chapters;
  std::filesystem::path out;
  bool force = false;
  reproduction::ReproduceOptions work;
};

struct Chapter {
  const char* name;
  reproduction::ChapterResult (*run)(const reproduction::ReproduceOptions&,
                                     const reproduction::ChapterProgress&);
};
constexpr Chapter kChapters[] = {{"2", reproduction::ReproduceChapter2},
                                 {"3", reproduction::ReproduceChapter3},
                                 {"4", reproduction::ReproduceChapter4},
                                 {"5", reproduction::ReproduceChapter5}};

/// RFC 4180: in quotes where it has to be.
std::string Cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += c;
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

std::string Cell(const std::optional<double>& number) {
  return number ? fmt::format("{:.6g}", *number) : "";
}

std::string TableText(const std::vector<reproduction::TableRow>& rows) {
  std::string text = "quantity,thesis,flextip,unit,note\n";
  for (const auto& row : rows)
    text += fmt::format("{},{},{},{},{}\n", Cell(row.quantity), Cell(row.thesis), Cell(row.flextip),
                        Cell(row.unit), Cell(row.note));
  return text;
}

reproduction::ChapterResult RunChapter(const Chapter& chapter,
                                       const reproduction::ReproduceOptions& options, bool quiet) {
  constexpr double kSteps = 1000.0;
  Progress progress(fmt::format("chapter {}", chapter.name), std::size_t(kSteps), quiet);
  return chapter.run(options, [&](double done) { progress.Update(std::size_t(done * kSteps)); });
}

void PrintRows(const std::vector<reproduction::TableRow>& rows) {
  fmt::print("{:>12} {:>12} {:<6} {}\n", "thesis", "flextip", "unit", "quantity");
  for (const auto& row : rows)
    fmt::print("{:>12} {:>12} {:<6} {}\n", Cell(row.thesis), Cell(row.flextip), row.unit,
               row.quantity);
}

void RunReproduce(const Options& options, const AppContext& context) {
  OutputFolder output(options.out, "reproduce", {.force = options.force});
  reproduction::ChapterResult all;
  nlohmann::json chapters = nlohmann::json::array();
  for (const auto& chapter : kChapters) {
    if (options.chapters != "all" && options.chapters != chapter.name) continue;
    const auto start = std::chrono::steady_clock::now();
    reproduction::ChapterResult result = RunChapter(chapter, options.work, context.quiet);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    chapters.push_back({{"chapter", chapter.name},
                        {"seconds", seconds.count()},
                        {"numbers", result.rows.size()},
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
  if (context.quiet) return;
  PrintRows(all.rows);
  fmt::print("{}\n", (output.name() / "report.html").string());
}

}  // namespace

void AddReproduce(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("reproduce", "The thesis's figures and numbers beside ours");
  auto options = std::make_shared<Options>();
  command->add_option("chapters", options->chapters, "2, 3, 4, 5 or all")
      ->required()
      ->check(CLI::IsMember({"2", "3", "4", "5", "all"}));
  command->add_option("-o,--output", options->out, "Folder for the results")->required();
  command->add_option("--seed", options->work.seed, "Of every random draw (1)");
  command->add_flag("--quick", options->work.quick, "Coarse and short: to see what there is");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer("Example:\n  flextip reproduce 2 -o chapter2\n");
  OnRun(*command, context, [options, &context] { RunReproduce(*options, context); });
}

}  // namespace flextip
