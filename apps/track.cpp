// flextip track: tags and the tip in the frames of a recording.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/frames.h"
#include "apps/output.h"
#include "apps/overlay.h"
#include "apps/progress.h"
#include "apps/tip_score.h"
#include "core/error.h"
#include "recording/csv.h"
#include "recording/recording_reader.h"
#include "recording/sensor_streams.h"
#include "recording/series_file.h"
#include "recording/text.h"
#include "report/pages.h"
#include "vision/tip_tracker.h"

namespace flextip {
namespace {

constexpr std::size_t kPicturesOfReport = 6, kPicturesOfOverlay = 24;

struct TrackOptions {
  std::filesystem::path recording, out, truth;
  TrackerOptions tracker;
  bool overlay = false, force = false;
};

struct TrackResult {
  VisionStream vision;
  Series<std::vector<TagDetection>> tags;
  int ok = 0, predicted = 0, lost = 0;
  double seconds = 0.0;  // reading and tracking, without drawing
  double squared_direction_noise = 0.0, squared_rms_px = 0.0;  // sums over ok
};

// Draws every frame into the video and some into files.
class OverlayWriter {
 public:
  OverlayWriter(const std::filesystem::path& folder, std::size_t frames, double rate_hz, bool video)
      : folder_(folder) {
    const std::size_t pictures = video ? kPicturesOfOverlay : kPicturesOfReport;
    every_ = std::max<std::size_t>(1, (frames + pictures - 1) / pictures);
    if (video) video_.emplace(folder / "overlay.mp4", rate_hz);
  }

  void Add(const Frame& frame, const TipTrack& track, const CameraCalibration& camera,
           const TagCollar& collar) {
    const bool picture = count_++ % every_ == 0;
    if (!picture && !video_) return;
    Image image = frame.image;
    DrawTrack(image, track, camera, collar);
    if (picture) WritePng(folder_ / "overlay" / fmt::format("{}.png", frame.t_ns), image);
    if (video_) video_->Add(image);
  }
  void Finish() {
    if (video_) video_->Finish();
  }

 private:
  std::filesystem::path folder_;
  std::size_t every_ = 1, count_ = 0;
  std::optional<VideoFile> video_;
};

Recording ReadForTracking(const TrackOptions& options, OutputFolder& output) {
  ReadResult read = ReadRecording(options.recording);
  output.Warn(read.warnings);
  const auto require = [&](bool present, const char* what) {
    if (!present) {
      throw InputError::At(options.recording.string(), 0,
                           fmt::format("no {}, tracking needs it", what));
    }
  };
  require(read.recording.cam0.has_value(), "cam0/");
  require(read.recording.tags0.has_value(), "tags0/");
  return read.recording;
}

void AddFrame(const TipTrack& track, TimeNs t_ns, TrackResult& result) {
  result.vision.tips.push_back({t_ns, track.tip});
  result.tags.push_back({t_ns, track.tags});
  result.ok += track.tip.status == TipStatus::kOk;
  result.predicted += track.tip.status == TipStatus::kPredicted;
  result.lost += track.tip.status == TipStatus::kLost;
  if (track.tip.status != TipStatus::kOk) return;
  result.squared_direction_noise += track.direction_noise_rad * track.direction_noise_rad;
  result.squared_rms_px += track.rms_px * track.rms_px;
}

TrackResult TrackFrames(const TrackOptions& options, const Recording& recording,
                        OutputFolder& output, bool quiet) {
  using Clock = std::chrono::steady_clock;
  const CameraStream& camera = *recording.cam0;
  FrameReader frames(options.recording, camera);
  TipTracker tracker(camera.calibration, *recording.tags0, options.tracker);
  OverlayWriter overlay(output.folder(), frames.Count(), camera.calibration.rate_hz,
                        options.overlay);
  Progress progress("frames", frames.Count(), quiet);
  TrackResult result;
  while (true) {
    const auto start = Clock::now();
    const std::optional<Frame> frame = frames.Next();
    if (!frame) break;
    const TipTrack track = tracker.Track(frame->image, frame->t_ns);
    result.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    AddFrame(track, frame->t_ns, result);
    overlay.Add(*frame, track, camera.calibration, *recording.tags0);
    progress.Update(result.tags.size());
  }
  overlay.Finish();
  if (result.tags.empty()) {
    throw InputError::At(options.recording.string(), 0, "no frame of cam0 can be read");
  }
  if (result.tags.size() < frames.Count()) {
    output.Warn(
        fmt::format("the video ends after {} of {} frames", result.tags.size(), frames.Count()));
  }
  result.vision.rate_hz = camera.calibration.rate_hz;
  result.vision.comment = "tip by tags";
  result.vision.direction_noise_rad =
      std::sqrt(result.squared_direction_noise / std::max(1, result.ok));
  return result;
}

std::string TagTable(const Series<std::vector<TagDetection>>& frames) {
  CsvWriter csv({kTimeColumn, "id []", "c0_x [px]", "c0_y [px]", "c1_x [px]", "c1_y [px]",
                 "c2_x [px]", "c2_y [px]", "c3_x [px]", "c3_y [px]", "decision_margin []",
                 "hamming []"});
  for (const auto& frame : frames) {
    for (const TagDetection& tag : frame.value) {
      csv.Add(frame.t_ns).Add(static_cast<TimeNs>(tag.id));
      for (const Eigen::Vector2d& c : tag.corners_px) csv.Add(c.x()).Add(c.y());
      csv.Add(tag.decision_margin).Add(static_cast<TimeNs>(tag.hamming));
      csv.EndRow();
    }
  }
  return csv.text();
}

nlohmann::json Summary(const TrackResult& r) {
  std::size_t tags = 0;
  for (const auto& frame : r.tags) tags += frame.value.size();
  const auto frames = static_cast<double>(r.tags.size());
  nlohmann::json summary = {{"frames", r.tags.size()},
                            {"ok", r.ok},
                            {"predicted", r.predicted},
                            {"lost", r.lost},
                            {"frames_per_second", frames / std::max(r.seconds, 1e-9)},
                            {"tags_per_frame", static_cast<double>(tags) / frames}};
  if (r.ok > 0) summary["rms_reprojection_error_px"] = std::sqrt(r.squared_rms_px / r.ok);
  return summary;
}

void AddScore(const TipScore& score, nlohmann::json& summary, OutputFolder& output) {
  summary["scored_frames"] = score.frames;
  if (score.frames == 0) {
    output.Warn("no frame with the tip seen falls into the truth's time");
    return;
  }
  summary["tip_rms_error_m"] = score.rms_error_m;
  summary["tip_max_error_m"] = score.max_error_m;
  summary["tip_rms_error_across_m"] = score.rms_across_m;
  summary["tip_rms_error_depth_m"] = score.rms_depth_m;
  summary["tip_mean_nees"] = score.mean_nees;
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

void RunTrack(const TrackOptions& options, bool quiet) {
  SilenceVideoCodecs();
  std::vector<std::filesystem::path> inputs{options.recording};
  if (!options.truth.empty()) inputs.push_back(options.truth);
  OutputFolder output(options.out, "track", {.force = options.force, .inputs = inputs});
  const Recording recording = ReadForTracking(options, output);
  const auto truth = ReadTipTruth(options.recording, options.truth);
  const TrackResult result = TrackFrames(options, recording, output, quiet);
  nlohmann::json summary = Summary(result);
  if (truth) {
    AddScore(ScoreTips(result.vision.tips, *truth, recording.cam0->calibration.T_RC), summary,
             output);
  }
  WriteVision(output.folder() / "vision0", result.vision);
  WriteTags(output.folder() / "tags0", *recording.tags0);
  WriteTextFile(output.folder() / "tags0" / "data.csv", TagTable(result.tags));
  output.WriteSummary(summary);
  WriteTrackReport(output.folder());
  output.Commit();
  if (!quiet) PrintResult(options, summary);
}

}  // namespace

void AddTrack(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("track", "Localise tags and the tip in recorded frames");
  auto options = std::make_shared<TrackOptions>();
  command->add_option("recording", options->recording, "Folder with cam0/ and tags0/")
      ->required()
      ->type_name("RECORDING");
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
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer("Example:\n  flextip track RECORDING -o OUT --overlay\n");
  OnRun(*command, context, [options, &context] { RunTrack(*options, context.quiet); });
}

}  // namespace flextip
