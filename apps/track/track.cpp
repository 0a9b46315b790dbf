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
#include "apps/common/input/findings.h"
#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/track/check.h"
#include "apps/track/options.h"
#include "apps/track/overlay.h"
#include "apps/track/summary.h"
#include "apps/track/tables.h"
#include "core/error.h"
#include "pipeline/instrument_tracker.h"
#include "pipeline/judge_track.h"
#include "recording/frames/track_input.h"
#include "recording/tip_score.h"
#include "report/pages.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {
namespace {

// The shaft whose outline carries a tip on. A recording does not say how its shaft ends, and its
// outer_diameter_m may be that of the part that bends: so only where it was asked for.
std::optional<TubeShape> ShaftSeen(const TrackOptions& options, const TrackInput& input) {
  if (options.end.empty()) return {};
  const double diameter_m =
      options.diameter_m > 0 ? options.diameter_m : input.recording.instrument.outer_diameter_m;
  if (!(diameter_m > 0)) {
    throw InputError::At(options.InputName(), 0,
                         "is no recording, expected --diameter LENGTH with --outline");
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
  while (!output.StopRequested() && (options.max_frames == 0 || tables.sums.frames < total)) {
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
  if (!overlay.PlaysInBrowsers()) {
    output.Warn(
        "overlay.mp4 is MPEG-4 part 2, which browsers do not play: no encoder of H.264 or "
        "VP9 was found");
  }
  if (tables.sums.frames == 0) {
    throw InputError::At(options.InputName(), 0, "no frame can be read");
  }
  if (options.IsRecording() && options.max_frames == 0 && tables.sums.frames < count) {
    output.Warn(fmt::format("the video ends after {} of {} frames", tables.sums.frames, count));
  }
}

void PrintResult(const TrackOptions& options, const nlohmann::json& summary) {
  fmt::print("{:.1f} frames per second\n", summary["frames_per_second"].get<double>());
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
  CheckTrackOptions(options);
  OutputFolder output(options.out, "track",
                      {.force = options.force,
                       .inputs = options.Files(),
                       .resume = options.resume,
                       .paths = options.Paths()});
  TrackInput input = OpenTrackInput(options);
  output.Warn(input.warnings);
  const auto findings = CheckTrackInput(options, input, quiet);
  output.Beware(FindingsJson(findings));
  options.tracker.tube = ShaftSeen(options, input);
  std::optional<Series<Eigen::Vector3d>> truth;
  if (options.IsRecording() || !options.truth.empty()) {
    truth = ReadTipTruth(options.source, options.truth);
  }
  TrackTables tables(output.folder(), options.RunName(), output.resumed());
  if (options.resume) {
    output.Warn(tables.sums.frames > 0
                    ? fmt::format("interrupted after {} frames and resumed{}", tables.sums.frames,
                                  options.overlay ? "; the overlay begins there" : "")
                    : "no interrupted run was found: began anew");
    if (output.resumed()) output.KeepUnfinished();
  }
  if (options.until_stopped) {
    output.OnlyNoteInterrupt();
  } else {
    output.KeepInterrupted();
  }
  TrackFrames(options, input, truth, output, tables, quiet);
  const TrackSums& sums = tables.sums;
  const int cameras = static_cast<int>(input.frames->Cameras());
  nlohmann::json summary = TrackSummary(sums, cameras, truth.has_value());
  if (!input.recording.cam0->has_T_RC) summary["frame"] = "C";
  if (!input.calibrations.empty()) summary["calibrations"] = CalibrationsJson(input.calibrations);
  if (truth && sums.score.frames == 0) {
    output.Warn("no frame with the tip seen falls into the truth's time");
  }
  tables.Finish(*input.recording.tags0, input.recording.cam0->calibration.rate_hz,
                input.recording.cam0->has_T_RC);
  Judgement judged =
      JudgeTrack(sums.Totals(input.recording.tags0->family, input.recording.cam0->has_T_RC,
                             input.recording.wrist0.has_value()));
  MentionFindings(findings, judged);
  summary["verdict"] = JudgementJson(judged);
  output.WriteSummary(summary);
  report::WriteTrackReport(output.folder());
  output.Commit();
  PrintJudgement(judged, output.paths(), quiet);
  RequireFound(judged, output.paths());
  if (!quiet) PrintResult(options, summary);
}

}  // namespace

void AddTrack(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("track", "Localise tags and the tip in frames");
  auto options = std::make_shared<TrackOptions>();
  AddTrackOptions(*command, *options);
  OnRun(*command, context, [options, &context] {
    if (!context.defaults.empty()) options->LeaveDefaultsOfPlainPictures();
    RunTrack(*options, context.quiet);
  });
}

}  // namespace flextip
