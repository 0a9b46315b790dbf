// flextip check: whether a recording can be what it says.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/input/calibration_input.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/whole_check.h"
#include "apps/common/next_step.h"
#include "apps/common/output.h"
#include "core/error.h"
#include "recording/recording_reader.h"
#include "report/pages.h"

namespace flextip {
namespace {

using plausibility::CheckResult;
using plausibility::Finding;
using plausibility::Severity;
using plausibility::StreamFacts;

struct CheckOptions {
  std::filesystem::path recording, out;
  CalibrationFiles calibrations;
  bool json = false, no_pictures = false, force = false;
};

double SecondsBetween(TimeNs from, TimeNs to) { return 1e-9 * static_cast<double>(to - from); }

nlohmann::json ToJson(const CheckResult& result) {
  nlohmann::json streams = nlohmann::json::array();
  for (const StreamFacts& s : result.streams) {
    streams.push_back({{"stream", s.name},
                       {"samples", s.samples},
                       {"first_ns", std::to_string(s.first_ns)},
                       {"last_ns", std::to_string(s.last_ns)},
                       {"duration_s", SecondsBetween(s.first_ns, s.last_ns)},
                       {"median_rate_hz", s.median_rate_hz},
                       {"stated_rate_hz", s.stated_rate_hz},
                       {"largest_gap_s", s.largest_gap_s},
                       {"overlap_with_wrist", s.overlap_with_wrist}});
  }
  const auto wrong = static_cast<std::size_t>(
      std::count_if(result.findings.begin(), result.findings.end(),
                    [](const Finding& f) { return f.severity == Severity::kWrong; }));
  return {{"streams", streams},
          {"findings", FindingsJson(result.findings)},
          {"wrong", wrong},
          {"doubtful", result.findings.size() - wrong}};
}

void Print(const CheckResult& result) {
  for (const StreamFacts& s : result.streams) {
    fmt::print("{:9} {:7} samples, {:9.3f} s, {:7.4g} Hz", s.name, s.samples,
               SecondsBetween(s.first_ns, s.last_ns), s.median_rate_hz);
    if (s.stated_rate_hz > 0.0) fmt::print(" (stated {:.4g})", s.stated_rate_hz);
    fmt::print(", largest gap {:.3g} s", s.largest_gap_s);
    if (s.name != "wrist0") fmt::print(", {:.0f} % with wrist0", 100.0 * s.overlap_with_wrist);
    fmt::print("\n");
  }
  if (result.findings.empty()) fmt::print("nothing found\n");
  for (const Finding& f : result.findings) fmt::print("{}", FindingText(Name(f.severity), f));
}

void RunCheck(const CheckOptions& options, bool quiet) {
  ReadResult read = ReadRecording(options.recording, {.check_frames = false});
  const auto used = ApplyCalibrations(options.calibrations, read.recording, read.warnings);
  const CheckResult result = CheckWhole(options.recording, read.recording, !options.no_pictures);
  nlohmann::json json = ToJson(result);
  if (!used.empty()) json["calibrations"] = CalibrationsJson(used);
  if (!options.out.empty()) {
    OutputFolder output(options.out, "check",
                        {.force = options.force, .inputs = {options.recording}});
    output.Warn(read.warnings);
    output.WriteSummary(json);
    report::WriteCheckReport(output.folder());
    output.Commit();
  }
  if (options.json) {
    fmt::print("{}\n", json.dump(2));
  } else if (!quiet) {
    Print(result);
    if (!options.out.empty()) PrintNextOf(options.out);
  }
  if (result.AnythingWrong()) {
    const auto wrong = json["wrong"].get<std::size_t>();
    throw WorkError(fmt::format("{}: {} {} wrong", options.recording.string(), wrong,
                                wrong == 1 ? "thing is" : "things are"));
  }
}

}  // namespace

void AddCheck(CLI::App& app, AppContext& context) {
  auto* command =
      app.add_subcommand("check", "Whether a recording can be what it says: units, frames, clocks");
  auto options = std::make_shared<CheckOptions>();
  command->add_option("recording", options->recording, "Folder of the recording")
      ->required()
      ->type_name("RECORDING");
  command->add_option("-o,--output", options->out, "Folder for the results")->type_name("OUT");
  AddCalibrationOption(*command, options->calibrations);
  command->add_flag("--json", options->json, "Print streams and findings as JSON");
  command->add_flag("--no-pictures", options->no_pictures, "Leave out the look at cam0's pictures");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer("Example:\n  flextip check recording -o check\n");
  OnRun(*command, context, [options, &context] { RunCheck(*options, context.quiet); });
}

}  // namespace flextip
