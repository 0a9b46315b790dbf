// flextip import: other people's data as a recording, one sub-command a format.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/output.h"
#include "apps/import/options.h"
#include "core/error.h"
#include "exchange/import.h"
#include "exchange/tables/times.h"
#include "recording/recording_reader.h"
#include "report/pages.h"

namespace flextip {
namespace {

using exchange::Imported;
using exchange::StreamLine;

// What is missing, with the options that tell it.
Imported ImportOrName(const exchange::ImportPlan& plan) {
  try {
    return exchange::Import(plan);
  } catch (const exchange::NotTold& missing) {
    std::string options;
    for (const auto& key : missing.keys()) {
      const std::string option = OptionFor(key);
      if (option.empty() || options.find(option) != std::string::npos) continue;
      options += (options.empty() ? "" : ", ") + option;
    }
    throw InputError(fmt::format("{} (tell it with {})", missing.what(), options));
  }
}

// Every stream must come back as it was written.
std::vector<StreamLine> ReadBack(const std::filesystem::path& folder, const Imported& imported) {
  ReadResult read;
  try {
    read = ReadRecording(folder);
  } catch (const InputError& error) {
    throw WorkError(
        fmt::format("what was imported does not read as a recording: {}", error.what()));
  }
  const auto lines = exchange::DescribeStreams(read.recording);
  const auto written = exchange::DescribeStreams(imported.recording);
  bool same = lines.size() == written.size();
  for (std::size_t i = 0; same && i < lines.size(); ++i) {
    same = lines[i].samples == written[i].samples && lines[i].first_ns == written[i].first_ns &&
           lines[i].last_ns == written[i].last_ns;
  }
  if (!same) throw WorkError("what was read back differs from what was imported");
  return lines;
}

// "length mm, time s": as the stream's columns were read.
std::string UnitsText(const Imported& imported, const std::string& stream) {
  const auto& streams = imported.plan.streams;
  const auto found = streams.find(stream);
  std::string text;
  if (found == streams.end()) return text;
  for (const auto& [kind, unit] : found->second.units) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kind, unit);
  }
  return text;
}

nlohmann::json StreamsJson(const Imported& imported, const std::vector<StreamLine>& lines) {
  nlohmann::json json = nlohmann::json::array();
  for (const auto& line : lines) {
    const auto skipped = imported.skipped.find(line.name);
    json.push_back({{"name", line.name},
                    {"samples", line.samples},
                    {"seconds", line.Seconds()},
                    {"rate_hz", line.rate_hz},
                    {"first_time_ns", line.first_ns},
                    {"first_value", line.first_value},
                    {"units", UnitsText(imported, line.name)},
                    {"skipped", skipped == imported.skipped.end() ? 0 : skipped->second}});
  }
  return json;
}

void Print(const Imported& imported, const std::vector<StreamLine>& lines,
           const std::filesystem::path& out) {
  for (const auto& [key, what] : imported.log.assumed) fmt::print("assumed {}: {}\n", key, what);
  for (const auto& warning : imported.log.warnings) fmt::print("warning: {}\n", warning);
  for (const auto& line : lines) {
    const std::string units = UnitsText(imported, line.name);
    fmt::print("{}: {} samples, {:.6g} s at {:.6g} Hz, first at {} s: {}{}\n", line.name,
               line.samples, line.Seconds(), line.rate_hz, exchange::SecondsText(line.first_ns),
               line.first_value, units.empty() ? "" : " (read as " + units + ")");
  }
  fmt::print("{}: confirmed by what was read back\n", out.string());
}

void RunImport(const ImportOptions& options, const std::string& format, bool quiet) {
  const exchange::ImportPlan plan = PlanOf(options);
  if (plan.streams.empty() && plan.files.empty() && !plan.video) {
    throw InputError(
        fmt::format("import {}: no file, expected FILE, --stream STREAM=FILE or a "
                    "mapping file",
                    format));
  }
  OutputFolder output(options.out, "import " + format,
                      {.force = options.force, .inputs = FilesOf(plan, options)});
  const Imported imported = ImportOrName(plan);
  exchange::WriteImported(output.folder(), imported);
  const auto lines = ReadBack(output.folder(), imported);
  for (const auto& [key, what] : imported.log.assumed) {
    output.Warn(fmt::format("assumed {}: {}", key, what));
  }
  output.Warn(imported.log.warnings);
  output.WriteSummary({{"streams", StreamsJson(imported, lines)}});
  report::WriteImportReport(output.folder());
  output.Commit();
  if (!quiet) Print(imported, lines, options.out);
}

void AddImportCsv(CLI::App& import, AppContext& context) {
  auto* command =
      import.add_subcommand("csv", "Tables: a robot's log, a tracker's CSV, a force log");
  auto options = std::make_shared<ImportOptions>();
  command->add_option("files", options->files, "Tables whose names or columns say what they are")
      ->type_name("FILE");
  AddImportOptions(*command, *options);
  command->footer(
      "Separators, decimal commas, headers, units and times are found by looking. Whatever is\n"
      "assumed is printed, and kept in RECORDING/import.yaml, which --map takes again.\n\n"
      "Example:\n  flextip import csv robot.csv --stream em0=aurora.csv -o recording \\\n"
      "    --length 0.6 --diameter 0.00238 --stiffness 0.304 --port 0.28,0,0 \\\n"
      "    --set em0.distance_from_tip_m=0.02\n");
  OnRun(*command, context, [options, &context] { RunImport(*options, "csv", context.quiet); });
}

void AddImportVideo(CLI::App& import, AppContext& context) {
  auto* command = import.add_subcommand("video", "A video with its camera and collar, and tables");
  auto options = std::make_shared<ImportOptions>();
  AddVideoOptions(*command, *options);
  AddImportOptions(*command, *options);
  command->footer(
      "--offset SECONDS without a stream is that of the video. --unit cam0=ms and\n"
      "--column cam0.t=NAME belong to --times.\n\n"
      "Example:\n  flextip import video scope.mp4 --camera camera.yaml --collar tags.yaml \\\n"
      "    --times frames.txt --no-pose -o recording --settings recording.yaml\n");
  OnRun(*command, context, [options, &context] { RunImport(*options, "video", context.quiet); });
}

}  // namespace

void AddImport(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("import", "Other people's data as a recording");
  command->require_subcommand(1);
  command->footer("Example:\n  flextip import csv --help\n");
  AddImportCsv(*command, context);
  AddImportVideo(*command, context);
}

}  // namespace flextip
