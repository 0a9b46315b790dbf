// flextip calibrate tip: the tip in the frame of wrist, sensor or tag collar, from turning about
// it.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/tip/output.h"
#include "apps/calibrate/verdict_json.h"
#include "apps/common/input/command_uses.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/input_check.h"
#include "apps/common/input/recording_input.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "calibration/entries.h"
#include "calibration/tip/tip_poses.h"
#include "calibration/verdict/tip.h"
#include "core/error.h"
#include "pipeline/instrument_tracker.h"
#include "recording/frames/frames.h"
#include "recording/frames/track_input.h"
#include "recording/text/text.h"
#include "report/pages.h"

namespace flextip {
namespace {

struct CalibrateTipOptions {
  RecordingInput input;
  std::string sensor;
  bool force = false;
};

/// What is turned: its name in calibration.yaml and the letter of its frame.
struct TipBody {
  std::string tip_name, frame;
  std::vector<PivotPose> poses;
  bool separate_noise = true;
};

InputError Missing(const CalibrateTipOptions& options, const std::string& what) {
  return InputError::At(options.input.recording.string(), 0, what);
}

std::string ChooseSensor(const CalibrateTipOptions& options, const Recording& recording) {
  if (!options.sensor.empty()) return options.sensor;
  if (!WristPoses(recording).empty()) return "wrist0";
  if (recording.cam0 && recording.tags0) return "tags0";
  if (recording.em0) return "em0";
  throw Missing(
      options,
      "found no wrist0/ with orientations, no cam0/ with tags0/ and no em0/, expected one");
}

TipBody CollarBody(const CalibrateTipOptions& options, OutputFolder& output, bool quiet) {
  SilenceVideoCodecs();
  TrackInput input =
      OpenRecordingToTrack(options.input.recording, {.calibrations = options.input.calibrations});
  output.Warn(input.warnings);
  InstrumentTracker tracker(TrackerSetupOf(input.recording, {}, false));
  Progress progress("frames", input.frames->Count(), quiet, "fps");
  TipBody body{"tags0.p_E", "E", {}, false};
  std::size_t frames = 0;
  while (const auto set = input.frames->Next()) {
    if (const auto pose = CollarPivotPose(
            tracker.Follow(set->Pointers(), set->t_ns, ReadingsAt(input.recording, set->t_ns)),
            set->t_ns)) {
      body.poses.push_back(*pose);
    }
    progress.Update(++frames);
  }
  if (body.poses.size() < frames) {
    output.Warn(fmt::format("the collar was not seen well in {} of {} frames",
                            frames - body.poses.size(), frames));
  }
  return body;
}

TipBody BodyOf(const CalibrateTipOptions& options, OutputFolder& output, bool quiet) {
  InputRead read = ReadInput(options.input);
  const std::string sensor = ChooseSensor(options, read.recording);
  const InputCheck check{options.input.no_check, quiet};
  output.Beware(FindingsJson(CheckInput(check, UseOfTip(sensor), read.recording)));
  if (sensor == "tags0") return CollarBody(options, output, quiet);
  output.Warn(read.warnings);
  if (sensor == "em0") {
    if (!read.recording.em0) throw Missing(options, "found no em0/, --sensor em0 needs it");
    return {"tip.p_SE", "S", EmPoses(read.recording)};
  }
  TipBody body{"tip.p_WE", "W", WristPoses(read.recording)};
  if (body.poses.empty()) {
    throw Missing(options, "found no wrist0/ with orientations, --sensor wrist0 needs them");
  }
  return body;
}

void PrintResult(const CalibrateTipOptions& options, const PivotResult& result,
                 const TipBody& body) {
  if (!result.IsUsable()) {
    fmt::print("{} cannot be named: {}\n", body.tip_name, result.unobservable);
  } else {
    const Eigen::Vector3d p = 1e3 * result.p_BE;
    const Eigen::Vector3d sd = 1e3 * result.covariance.diagonal().head<3>().cwiseSqrt();
    fmt::print("{} ({:.3f}, {:.3f}, {:.3f}) mm, standard deviations ({:.3f}, {:.3f}, {:.3f}) mm\n",
               body.tip_name, p.x(), p.y(), p.z(), sd.x(), sd.y(), sd.z());
    fmt::print("{} of {} poses used, residual {:.3f} mm RMS per component, held out {:.3f} mm\n",
               result.used, body.poses.size(), 1e3 * result.rms_m, 1e3 * result.heldout_rms_m);
  }
  fmt::print("{}\n", (options.input.out / "calibration.yaml").string());
}

void RunCalibrateTip(const CalibrateTipOptions& options, bool quiet) {
  OutputFolder output(options.input.out, "calibrate tip",
                      {.force = options.force,
                       .inputs = {options.input.recording},
                       .paths = options.input.Paths()});
  const TipBody body = BodyOf(options, output, quiet);
  const PivotResult result = CalibratePivot(body.poses, {.separate_noise = body.separate_noise});
  if (!result.IsUsable()) {
    output.Warn(fmt::format("{} cannot be named: {}", body.tip_name, result.unobservable));
  }
  WriteCalibration(output.folder() / "calibration.yaml", TipEntries(result, body.tip_name));
  if (!result.residuals.empty()) {
    WriteTextFile(output.folder() / "residuals.csv", TipResidualTable(body.poses, result));
    report::WriteFigures(output.folder() / "figures.json", TipFigures(body.poses, result));
  }
  auto summary = TipSummary(body.poses, result, body.tip_name, body.frame);
  summary["verdict"] = VerdictJson(JudgeTip(result, body.tip_name, body.frame));
  output.WriteSummary(summary);
  report::WriteCalibrateReport(output.folder());
  output.Commit();
  if (!quiet) PrintResult(options, result, body);
}

}  // namespace

void AddCalibrateTip(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand(
      "tip", "Where the tip is on the wrist, a sensor or the tag collar, from turning about it");
  auto options = std::make_shared<CalibrateTipOptions>();
  AddRecordingInput(*command, options->input);
  command
      ->add_option("--sensor", options->sensor,
                   "wrist0, em0, or tags0 (the collar in the frames); without it the first there "
                   "is of wrist0, tags0, em0")
      ->check(CLI::IsMember({"wrist0", "em0", "tags0"}))
      ->type_name("SENSOR");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Hold the tip in a divot and turn the instrument about it, to all sides.\n"
      "Example:\n"
      "  flextip calibrate tip RECORDING -o tip\n");
  OnRun(*command, context, [options, &context] { RunCalibrateTip(*options, context.quiet); });
}

}  // namespace flextip
