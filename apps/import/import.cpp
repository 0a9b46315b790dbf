// flextip import: other people's data as a recording, one sub-command a format.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/whole_check.h"
#include "apps/common/next_step.h"
#include "apps/common/output.h"
#include "apps/import/options.h"
#include "core/error.h"
#include "exchange/import.h"
#include "exchange/values/times.h"
#include "recording/recording_reader.h"
#include "report/pages.h"

namespace flextip {
namespace {

using exchange::Imported;
using exchange::StreamLine;

// Says the options that tell what is missing.
Imported ImportOrName(const exchange::ImportPlan& plan) {
  try {
    return exchange::Import(plan);
  } catch (const exchange::NotTold& error) {
    std::string text;
    for (const auto& missing : error.missing()) {
      std::vector<std::string> options;
      for (const auto& key : missing.keys) {
        const std::string option = OptionFor(key);
        if (!option.empty()) options.push_back(option);
      }
      text += fmt::format("{}{}", text.empty() ? "" : "; ", missing.what);
      if (!options.empty()) text += fmt::format(" (tell it with {})", fmt::join(options, ", "));
    }
    throw InputError(text);
  }
}

// Every stream must come back as it was written.
Recording ReadBack(const std::filesystem::path& folder, const Imported& imported) {
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
  return std::move(read.recording);
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

nlohmann::json AssumedJson(const Imported& imported) {
  nlohmann::json json = nlohmann::json::array();
  for (const auto& [key, what] : imported.log.assumed)
    json.push_back({{"name", key}, {"is", what}});
  return json;
}

void Print(const Imported& imported, const std::vector<StreamLine>& lines,
           const plausibility::CheckResult& check, const std::filesystem::path& out) {
  for (const auto& [key, what] : imported.log.assumed) fmt::print("assumed {}: {}\n", key, what);
  for (const auto& warning : imported.log.warnings) fmt::print("warning: {}\n", warning);
  for (const auto& line : lines) {
    const std::string units = UnitsText(imported, line.name);
    fmt::print("{}: {} samples, {:.6g} s at {:.6g} Hz, first at {} s: {}{}\n", line.name,
               line.samples, line.Seconds(), line.rate_hz, exchange::SecondsText(line.first_ns),
               line.first_value, units.empty() ? "" : " (read as " + units + ")");
  }
  fmt::print("{}: read back as it was written\n", out.string());
  for (const auto& finding : check.findings) {
    fmt::print("{}", FindingText(Name(finding.severity), finding));
  }
}

void RunImport(const ImportOptions& options, bool quiet) {
  const exchange::ImportPlan plan = PlanOf(options);
  const auto inputs = InputsOf(plan, options);
  if (inputs.empty()) {
    throw InputError(
        fmt::format("import {}: no file, expected one, --stream STREAM=FILE or --map "
                    "FILE",
                    options.format));
  }
  OutputFolder output(options.out, "import " + options.format,
                      {.force = options.force, .inputs = inputs});
  const Imported imported = ImportOrName(plan);
  exchange::WriteImported(output.folder(), imported);
  const Recording recording = ReadBack(output.folder(), imported);
  plausibility::CheckResult check;
  if (!options.no_check) check = CheckWhole(output.folder(), recording, true);
  auto lines = exchange::DescribeStreams(recording);
  lines.insert(lines.end(), imported.others.begin(), imported.others.end());
  output.Warn(imported.log.warnings);
  output.Beware(FindingsJson(check.findings));
  output.WriteSummary(
      {{"streams", StreamsJson(imported, lines)}, {"assumed", AssumedJson(imported)}});
  report::WriteImportReport(output.folder());
  output.Commit();
  if (quiet) return;
  Print(imported, lines, check, options.out);
  PrintNextOf(output.folder());
}

struct FormatHelp {
  const char *name, *says, *input, *inputs, *footer;
};

const FormatHelp kFormats[] = {
    {"csv", "Tables: a robot's log, a tracker's CSV, a force log", "FILE",
     "Tables whose names or columns say what they are",
     "Separators, decimal commas, headers, units and times are found by looking. Whatever is\n"
     "assumed is printed, and kept in RECORDING/import.yaml, which --map takes again.\n\n"
     "Example:\n  flextip import csv robot.csv --stream em0=aurora.csv -o recording \\\n"
     "    --length 0.6 --diameter 0.00238 --stiffness 0.304 --port 0.28,0,0 \\\n"
     "    --set em0.distance_from_tip_m=0.02 --axis em0=z\n"},
    {"video", "Videos of one or both eyes, with tables", "FILE", "Video; a second one is cam1",
     "--unit cam0=ms and --column cam0.t=NAME belong to --times.\n\n"
     "Example:\n  flextip import video scope.mp4 --camera camera.yaml --collar tags.yaml \\\n"
     "    --times frames.txt --stream wrist0=robot.csv --settings recording.yaml -o recording\n"},
    {"rosbag", "Bags of ROS 1", "FILE.bag", "Bags of one session",
     "Topics are told by their names (CRTK's measured_cp, setpoint_cp) and types: PoseStamped,\n"
     "TransformStamped, WrenchStamped, JointState, Image, CompressedImage, CameraInfo.\n\n"
     "Example:\n  flextip import rosbag session.bag --stream wrist0=/PSM1/measured_cp \\\n"
     "    --axis wrist0=z --settings recording.yaml -o recording\n"},
    {"mcap", "Bags of ROS 2 in MCAP", "PATH", "MCAP files, or the folder of a bag",
     "Topics as by import rosbag.\n\n"
     "Example:\n  flextip import mcap rosbag2_2024_05_01/ --stream em0=/aurora/tool1 \\\n"
     "    --axis em0=z --set em0.distance_from_tip_m=0.02 --settings recording.yaml \\\n"
     "    -o recording\n"},
    {"dvrk", "A session of the dVRK's recorder: index.json, videos with side-cars, a bag", "FOLDER",
     "The session's folder",
     "Videos need --camera; without it they are left out.\n\n"
     "Example:\n  flextip import dvrk 20260117_153206 --camera left.yaml --collar tags.yaml \\\n"
     "    --stream wrist0=/PSM1/measured_cp --settings recording.yaml -o recording\n"}};

void AddFormat(const FormatHelp& format, CLI::App& import, AppContext& context) {
  CLI::App& command = *import.add_subcommand(format.name, format.says);
  auto options = std::make_shared<ImportOptions>();
  options->format = format.name;
  auto* inputs = command.add_option("inputs", options->inputs, format.inputs);
  inputs->type_name(format.input);
  if (options->format == "dvrk") inputs->expected(1);
  if (options->format == "video") inputs->expected(1, 2);
  AddImportOptions(command, *options);
  command.footer(format.footer);
  OnRun(command, context, [options, &context] { RunImport(*options, context.quiet); });
}

}  // namespace

void AddImport(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("import", "Other people's data as a recording");
  command->require_subcommand(1);
  command->footer("Example:\n  flextip import csv --help\n");
  for (const FormatHelp& format : kFormats) AddFormat(format, *command, context);
}

}  // namespace flextip
