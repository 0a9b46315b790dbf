// flextip export: recordings and results for other programs and for viewers.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/stops/stops.h"
#include "core/error.h"
#include "exports/mcap/export_mcap.h"
#include "exports/text_files.h"
#include "live/recorder/excerpt.h"
#include "live/recorder/replay.h"
#include "report/drawing/page_figures.h"
#include "report/drawing/picture.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  fs::path input, out;
  std::vector<fs::path> more;
  std::string format = "svg";
  std::vector<std::string> units;
  bool force = false;
};

nlohmann::json FileList(const std::vector<exports::WrittenFile>& files) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& file : files) {
    list.push_back({{"file", file.file.filename().string()}, {"rows", file.rows}});
  }
  return list;
}

exports::TableUnits UnitsOf(const ExportOptions& options) {
  const auto asked = [&](const char* unit) {
    return std::find(options.units.begin(), options.units.end(), unit) != options.units.end();
  };
  return {.millimetres = asked("mm"), .degrees = asked("deg")};
}

/// Writes one kind of text file for each table into the folder OUT.
void RunTexts(const ExportOptions& options, const char* kind, bool quiet) {
  const auto tables = exports::ReadTimedTables(options.input);
  OutputFolder output(options.out, fmt::format("export {}", kind),
                      {.force = options.force, .inputs = {options.input}});
  const bool tum = std::string(kind) == "tum";
  const auto files = tum ? exports::WriteTum(tables, output.folder())
                         : exports::WritePlainCsv(tables, output.folder(), UnitsOf(options));
  for (const auto& file : files) {
    if (file.has_turn) continue;
    output.Warn(fmt::format("{}: no orientation was measured; the file has the identity",
                            file.file.filename().string()));
  }
  output.WriteSummary({{"files", FileList(files)}});
  const auto warnings = output.warnings();
  output.Commit();
  if (quiet) return;
  for (const auto& file : files) {
    fmt::print("{}  {} rows\n", (output.name() / file.file.filename()).string(), file.rows);
  }
  for (const auto& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
}

void RunPictures(const ExportOptions& options, bool quiet) {
  const auto figures = report::FiguresOfPage(options.input);
  if (figures.empty()) {
    throw InputError::At((options.input / "report.html").string(), 0, "has no figure");
  }
  OutputFolder output(options.out, "export pictures",
                      {.force = options.force, .inputs = {options.input}});
  nlohmann::json files = nlohmann::json::array();
  for (const auto& figure : figures) {
    const std::string name = figure.name + "." + options.format;
    report::WritePicture(output.folder() / name, {figure});
    files.push_back({{"file", name}, {"title", figure.title}});
  }
  output.WriteSummary({{"files", files}});
  output.Commit();
  if (!quiet) fmt::print("{} pictures in {}\n", figures.size(), output.name().string());
}

/// The stops of a recording of control, as the end of its run makes them: for one that was killed.
void RunStops(const ExportOptions& options, bool quiet) {
  if (!live::HasSession(options.input)) {
    throw InputError::At(options.input.string(), 0,
                         "has no session0/cycles.csv, expected a recording of flextip control");
  }
  OutputFolder output(options.out, "export stops",
                      {.force = options.force, .inputs = {options.input}});
  const StopsOfRun stops = live::WriteExcerpts(options.input, output.folder());
  nlohmann::ordered_json summary = nlohmann::ordered_json::object();
  AddStopsJson(stops, summary);
  output.WriteSummary(summary);
  WriteExcerptPages(output.folder(), stops, {options.input});
  output.Commit();
  if (quiet) return;
  PrintStops(stops, options.out);
  if (stops.found == 0) fmt::print("no stop was found\n");
}

/// Writes beside OUT and moves the file there when it is whole.
void RunMcap(const ExportOptions& options, bool quiet) {
  if (fs::exists(options.out) && !options.force) {
    throw InputError::At(options.out.string(), 0, "exists; --force replaces it");
  }
  const fs::path part = fmt::format("{}.partial-{}", options.out.string(), getpid());
  if (!options.out.parent_path().empty()) fs::create_directories(options.out.parent_path());
  exports::McapContent content;
  try {
    content =
        exports::ExportMcap(options.input, options.more, part, ProgressFunction("export", quiet));
  } catch (...) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw;
  }
  fs::rename(part, options.out);
  if (quiet) return;
  for (const auto& topic : content.topics) {
    fmt::print("{:<32} {:<28} {:>8}\n", topic.topic, topic.schema, topic.messages);
  }
  fmt::print("{} messages in {}\n", content.messages, options.out.string());
}

void AddInput(CLI::App& command, ExportOptions& options) {
  command.add_option("input", options.input, "Folder of a recording or of a command's result")
      ->required()
      ->type_name("FOLDER");
  command.add_option("-o,--output", options.out, "Where to write")->required()->type_name("OUT");
  command.add_flag("--force", options.force, "Replace OUT");
}

}  // namespace

void AddExport(CLI::App& app, AppContext& context) {
  auto* command =
      app.add_subcommand("export", "Recordings and results for viewers and other programs");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  flextip export mcap RECORDING -o recording.mcap     # for Foxglove and its like\n"
      "  flextip export tum RECORDING -o trajectories        # for evo\n"
      "  flextip export csv RECORDING -o tables\n"
      "  flextip export pictures RESULT -o pictures\n"
      "  flextip export stops RECORDING -o stops             # of a run that was killed\n");
  const auto add = [&](const char* name, const char* help, const char* footer) {
    auto* sub = command->add_subcommand(name, help);
    auto options = std::make_shared<ExportOptions>();
    AddInput(*sub, *options);
    sub->footer(footer);
    return std::pair{sub, options};
  };
  auto [mcap, mcap_options] =
      add("mcap", "Poses, paths, pictures with overlay and plots for viewers, as one file",
          "Example:\n  flextip export mcap RECORDING --with TRACKED -o recording.mcap\n");
  mcap->add_option("--with", mcap_options->more,
                   "Add the tables of this result of the recording (track, estimate); several")
      ->allow_extra_args(false)
      ->type_name("RESULT");
  OnRun(*mcap, context, [options = mcap_options, &context] { RunMcap(*options, context.quiet); });
  auto [tum, tum_options] = add("tum", "Trajectories: time_s x y z qx qy qz qw",
                                "Example:\n  flextip export tum RECORDING -o trajectories\n");
  OnRun(*tum, context,
        [options = tum_options, &context] { RunTexts(*options, "tum", context.quiet); });
  auto [stops, stop_options] =
      add("stops", "The last seconds before each stop of a controlled run, as recordings",
          "Example:\n  flextip export stops RECORDING -o stops\n");
  OnRun(*stops, context, [options = stop_options, &context] { RunStops(*options, context.quiet); });
  auto [csv, csv_options] =
      add("csv", "Tables with plain headers",
          "Example:\n  flextip export csv RECORDING --unit mm --unit deg -o tables\n");
  csv->add_option("--unit", csv_options->units, "mm in place of m, deg in place of rad; both")
      ->check(CLI::IsMember({"mm", "deg"}))
      ->allow_extra_args(false)
      ->type_name("UNIT");
  OnRun(*csv, context,
        [options = csv_options, &context] { RunTexts(*options, "csv", context.quiet); });
  auto [pictures, picture_options] =
      add("pictures", "Every figure of a result's page as a picture file",
          "Example:\n  flextip export pictures RESULT --format pdf -o pictures\n");
  pictures->add_option("--format", picture_options->format, "png, svg or pdf")
      ->check(CLI::IsMember({"png", "svg", "pdf"}))
      ->capture_default_str();
  OnRun(*pictures, context,
        [options = picture_options, &context] { RunPictures(*options, context.quiet); });
}

}  // namespace flextip
