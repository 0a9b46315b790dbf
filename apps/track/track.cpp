// flextip track: tags and the tip in the frames of a recording, of plain pictures or a video, or of
// a live camera.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/common/stop_signal.h"
#include "apps/track/input.h"
#include "apps/track/overlay.h"
#include "apps/track/summary.h"
#include "apps/track/tables.h"
#include "core/error.h"
#include "pipeline/instrument_tracker.h"
#include "report/pages.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {
namespace {

struct TrackOptions {
  TrackInputOptions input;
  std::filesystem::path out, truth;
  TrackerOptions tracker;
  std::vector<double> black_white;
  double rate_hz = 0.0;
  std::string end;          // of the shaft, where its outline is used
  double diameter_m = 0.0;  // of the shaft; 0: the recording's
  long max_frames = 0;      // 0: all
  bool no_model = false, overlay = false, force = false, resume = false;

  std::string InputName() const {
    if (!input.live.empty()) return input.live;
    return std::filesystem::weakly_canonical(input.source).string();
  }
  /// What a resumed run must have been given as well.
  std::string RunName() const {
    std::string name = InputName();
    for (const auto& file : input.calibrations) name += " with " + file.string();
    return name;
  }
};

void CheckOptions(TrackOptions& options) {
  if (!options.black_white.empty()) {
    options.input.range = {options.black_white[0], options.black_white[1]};
  }
  if (options.input.range.black >= options.input.range.white) {
    throw InputError(fmt::format("--black-white: found {},{}, expected the first below the second",
                                 options.input.range.black, options.input.range.white));
  }
  // Recorded frames give the same tables on every machine; live ones do not wait for a search.
  options.tracker.background_detection = !options.input.live.empty();
  if (options.rate_hz > 0) options.input.rate_hz = options.rate_hz;
  if (options.resume && !options.input.live.empty()) {
    throw InputError("--resume: a live source cannot be seen again");
  }
}

// The shaft whose outline carries a tip on. A recording does not say how its shaft ends, and its
// outer_diameter_m may be that of the part that bends: so only where it was asked for.
std::optional<TubeShape> ShaftSeen(const TrackOptions& options, const TrackInput& input) {
  if (options.end.empty()) return {};
  const double diameter_m =
      options.diameter_m > 0 ? options.diameter_m : input.recording.instrument.outer_diameter_m;
  if (!(diameter_m > 0)) {
    throw InputError::At(options.InputName(), 0,
                         "is no recording, expected --diameter METRES with --outline");
  }
  return TubeOf(*input.recording.tags0, diameter_m, options.end == "round");
}

std::string Remark(const TipTrack& track) {
  if (track.tip.status == TipStatus::kLost) return "tip lost";
  const Eigen::Vector3d p_mm = 1e3 * track.tip.p_RE;
  return fmt::format("tip {:.2f} {:.2f} {:.2f} mm {}", p_mm.x(), p_mm.y(), p_mm.z(),
                     Name(track.tip.status));
}

void TrackFrames(const TrackOptions& options, TrackInput& input,
                 const std::optional<Series<Eigen::Vector3d>>& truth, OutputFolder& output,
                 TrackTables& tables, bool quiet) {
  using Clock = std::chrono::steady_clock;
  const CameraCalibration& camera = input.recording.cam0->calibration;
  InstrumentTracker tracker(TrackerSetupOf(input.recording, options.tracker, !options.no_model));
  const long before = tables.sums.frames;
  if (before > 0) {
    tracker.SetState(tables.state());
    input.frames->Skip(static_cast<std::size_t>(before));
  }
  const auto count = static_cast<long>(input.frames->Count());
  const long total = options.max_frames > 0 && (count == 0 || options.max_frames < count)
                         ? options.max_frames
                         : count;
  const auto to_do = static_cast<std::size_t>(std::max(0L, total - before));
  OverlayWriter overlay(output.folder(), to_do, camera.rate_hz, options.overlay);
  Progress progress("frames", to_do, quiet, "fps");
  while (!StopSignal::Requested() && (options.max_frames == 0 || tables.sums.frames < total)) {
    const auto start = Clock::now();
    const std::optional<FrameSet> set = input.frames->Next();
    if (!set) break;
    const TipTrack track =
        tracker.Follow(set->Pointers(), set->t_ns, ReadingsAt(input.recording, set->t_ns));
    tables.sums.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    tables.Add(set->t_ns, track, truth ? ValueAt(*truth, set->t_ns) : std::nullopt, camera.T_RC);
    if (tables.IsSaveDue()) tables.Save(tracker.State());
    overlay.Add(*set, track, camera, *input.recording.tags0);
    progress.Update(static_cast<std::size_t>(tables.sums.frames - before), Remark(track));
  }
  overlay.Finish();
  if (tables.sums.frames == 0) {
    throw InputError::At(options.InputName(), 0, "no frame can be read");
  }
  if (input.is_recording && options.max_frames == 0 && tables.sums.frames < count) {
    output.Warn(fmt::format("the video ends after {} of {} frames", tables.sums.frames, count));
  }
}

void PrintResult(const TrackOptions& options, const nlohmann::json& summary) {
  fmt::print("{} frames: {} ok, {} predicted, {} lost, {:.1f} frames per second\n",
             summary["frames"].get<int>(), summary["ok"].get<int>(),
             summary["predicted"].get<int>(), summary["lost"].get<int>(),
             summary["frames_per_second"].get<double>());
  if (summary.contains("tip_rms_error_m")) {
    fmt::print("tip error {:.3f} mm RMS ({:.3f} mm across the view, {:.3f} mm in depth)\n",
               1e3 * summary["tip_rms_error_m"].get<double>(),
               1e3 * summary["tip_rms_error_across_m"].get<double>(),
               1e3 * summary["tip_rms_error_depth_m"].get<double>());
  }
  fmt::print("{}\n", (options.out / "report.html").string());
}

void RunTrack(TrackOptions options, bool quiet) {
  SilenceVideoCodecs();
  CheckOptions(options);
  std::vector<std::filesystem::path> inputs{options.input.source, options.truth};
  std::erase_if(inputs, [](const auto& path) { return path.empty(); });
  inputs.insert(inputs.end(), options.input.calibrations.begin(), options.input.calibrations.end());
  OutputFolder output(options.out, "track",
                      {.force = options.force, .inputs = inputs, .resume = options.resume});
  TrackInput input = OpenTrackInput(options.input);
  output.Warn(input.warnings);
  options.tracker.tube = ShaftSeen(options, input);
  std::optional<Series<Eigen::Vector3d>> truth;
  if (input.is_recording || !options.truth.empty()) {
    truth = ReadTipTruth(options.input.source, options.truth);
  }
  TrackTables tables(output.folder(), options.RunName(), output.resumed());
  if (options.resume) {
    output.Warn(tables.sums.frames > 0
                    ? fmt::format("interrupted after {} frames and resumed{}", tables.sums.frames,
                                  options.overlay ? "; the overlay begins there" : "")
                    : "no interrupted run was found: began anew");
    if (output.resumed()) output.KeepUnfinished();
  }
  std::optional<StopSignal> stop;
  if (!options.input.live.empty()) stop.emplace();
  TrackFrames(options, input, truth, output, tables, quiet);
  const TrackSums& sums = tables.sums;
  const int cameras = static_cast<int>(input.frames->Cameras());
  nlohmann::json summary = TrackSummary(sums, cameras, truth.has_value());
  if (!input.calibrations.empty()) summary["calibrations"] = CalibrationsJson(input.calibrations);
  if (truth && sums.score.frames == 0) {
    output.Warn("no frame with the tip seen falls into the truth's time");
  }
  tables.Finish(*input.recording.tags0, input.recording.cam0->calibration.rate_hz);
  output.WriteSummary(summary);
  report::WriteTrackReport(output.folder());
  output.Commit();
  if (!quiet) PrintResult(options, summary);
}

void AddInputOptions(CLI::App& command, TrackOptions& options) {
  command
      .add_option("recording", options.input.source,
                  "Recording with cam0/ and tags0/; or a folder of pictures or a video, with "
                  "--camera and --collar")
      ->type_name("RECORDING");
  command.add_option("--live", options.input.live, "A device number, URL or file, until Ctrl-C")
      ->type_name("SOURCE");
  command.add_option("--camera", options.input.camera, "Camera file: EuRoC, Kalibr, ROS or OpenCV")
      ->type_name("FILE");
  command.add_option("--collar", options.input.collar, "Collar file, as a recording's tags0")
      ->type_name("FILE");
  command
      .add_option("--rate", options.rate_hz,
                  "Of plain pictures or a video; without it names in nanoseconds, the video's rate")
      ->check(CLI::PositiveNumber)
      ->type_name("HZ");
  AddCalibrationOption(command, options.input.calibrations);
  command.add_option("--frames", options.max_frames, "End after so many")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command
      .add_option("--black-white", options.black_white,
                  "Values of 16-bit pictures that become 0 and 255; without it 0,65535")
      ->expected(2)
      ->delimiter(',')
      ->type_name("LOW,HIGH");
}

}  // namespace

void AddTrack(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("track", "Localise tags and the tip in frames");
  auto options = std::make_shared<TrackOptions>();
  AddInputOptions(*command, *options);
  command->add_option("-o,--output", options->out, "Folder for the results")->required();
  command->add_flag("--overlay", options->overlay, "Draw what was found into a video");
  command->add_option("--truth", options->truth, "Score against this CSV: timestamp [ns],x,y,z")
      ->type_name("FILE");
  command
      ->add_option("--decimate", options->tracker.detector.quad_decimate,
                   "Search tags at 1/this of the resolution: faster, misses small ones")
      ->capture_default_str();
  command->add_option("--threads", options->tracker.detector.threads, "Threads")
      ->capture_default_str();
  command->add_flag("--no-model", options->no_model,
                    "Carry a hidden tip on by its motion alone, not by wrist0 and the shaft");
  auto* outline =
      command
          ->add_option("--outline", options->end,
                       "Carry a tip whose tags are covered on by the shaft's outline; its end is "
                       "round or flat")
          ->check(CLI::IsMember({"round", "flat"}))
          ->type_name("END");
  command
      ->add_option("--diameter", options->diameter_m,
                   "Of the shaft as it is seen; without it the recording's outer_diameter_m")
      ->check(CLI::PositiveNumber)
      ->needs(outline)
      ->type_name("METRES");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->add_flag("--resume", options->resume, "Go on where an interrupted run ended");
  command->footer(
      "Examples:\n"
      "a recording (both eyes where it has cam1, the wrist where it has wrist0)\n"
      "  flextip track RECORDING -o OUT --overlay\n"
      "a folder of PNG, JPEG or TIFF pictures, here of a 12-bit camera at 50 Hz\n"
      "  flextip track pictures/ --camera sensor.yaml --collar collar.yaml --rate 50 "
      "--black-white 0,4095 -o OUT\n"
      "a video\n"
      "  flextip track video.mp4 --camera camera_info.yaml --collar collar.yaml -o OUT\n"
      "a camera that is plugged in, or a stream, until Ctrl-C\n"
      "  flextip track --live 0 --camera sensor.yaml --collar collar.yaml -o OUT\n"
      "  flextip track --live rtsp://HOST/STREAM --camera sensor.yaml --collar collar.yaml -o "
      "OUT\n"
      "tags that another instrument covers for a while, on a shaft with a round end\n"
      "  flextip track RECORDING --outline round -o OUT\n"
      "after an interruption\n"
      "  flextip track RECORDING -o OUT --resume\n");
  OnRun(*command, context, [options, &context] { RunTrack(*options, context.quiet); });
}

}  // namespace flextip
