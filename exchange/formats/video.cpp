// A video with its frames' times, camera and collar as cam0 and tags0.
#include <fmt/format.h>

#include <cmath>

#include "core/median.h"
#include "exchange/formats/formats.h"
#include "exchange/tables/stream_table.h"
#include "exchange/tables/times.h"
#include "exchange/tables/units.h"
#include "recording/cameras/camera_formats.h"
#include "recording/frames/video_info.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRateKey = "cam0.frame_rate_hz";

fs::path Whole(const fs::path& file) {
  return file.empty() ? file : fs::absolute(file).lexically_normal();
}

// A file with T_RC, or a calibration.yaml that found it.
Pose ReadPose(const fs::path& file) {
  const auto yaml = YamlMap::Load(file);
  if (yaml.Has("T_RC")) return yaml.Transform("T_RC");
  if (yaml.Has("found")) return yaml.Map("found").Transform("cam0.T_RC");
  throw yaml.Error("T_RC", "found neither T_RC nor found: cam0.T_RC, expected the camera's pose");
}

CameraCalibration ReadCameraOf(const VideoPlan& video, ImportLog& log) {
  const auto camera = ReadCameraDescription(video.camera, GuessCameraFormat(video.camera));
  CameraCalibration calibration = camera.calibration;
  if (!video.pose.empty()) {
    calibration.T_RC = ReadPose(video.pose);
  } else if (video.without_pose) {
    calibration.T_RC = Pose();
    log.Assume("cam0.T_RC",
               "identity: R is the camera's frame, so the tip is found relative to the camera; "
               "wrist, port and other sensors do not fit to it");
  } else if (!camera.has_T_RC) {
    throw NotTold(fmt::format("{}: does not say where the camera is (T_RC)", video.camera.string()),
                  {"video.pose", "video.without_pose"});
  }
  for (const auto& loss : camera.not_kept) {
    log.Warn(fmt::format("{}: not kept: {}", video.camera.string(), loss.what));
  }
  return calibration;
}

std::vector<TimeNs> TimesFromFile(VideoPlan& video, const VideoInfo& info, ImportLog& log) {
  video.times.offset_ns = video.offset_ns;
  const StreamRows rows = ReadStreamRows("cam0", video.times, log);
  video.times.offset_ns.reset();
  if (rows.t_ns.size() != info.frames) {
    throw InputError::At(video.times.file.string(), rows.lines.back(),
                         fmt::format("found {} times, expected {}: {} holds as many frames",
                                     rows.t_ns.size(), info.frames, video.file.string()));
  }
  return rows.t_ns;
}

TimeNs Start(VideoPlan& video, ImportLog& log) {
  if (video.start.empty()) {
    video.start = "0";
    log.Assume("cam0.start", "0 s: the first frame's time is not told");
  }
  const auto clock = ParseClock(video.start);
  const auto t_ns = clock ? clock->t_ns : DecimalTime(video.start, "s");
  if (!t_ns) {
    throw NotTold(fmt::format("found the start {}, expected seconds or 2024-05-01T12:00:00.123",
                              Quoted(video.start)),
                  {"video.start"});
  }
  if (clock && clock->has_date && !clock->has_zone) {
    log.Assume("cam0.clock", "UTC: the start states no zone");
  }
  return *t_ns + video.offset_ns.value_or(0);
}

std::vector<TimeNs> TimesByRate(VideoPlan& video, const VideoInfo& info, ImportLog& log) {
  double rate_hz = video.rate_hz.value_or(info.rate_hz);
  if (!(rate_hz > 0 && rate_hz < 1e5)) {
    throw NotTold(fmt::format("{}: does not state its rate", video.file.string()),
                  {"video.rate_hz", "video.times"});
  }
  if (!video.rate_hz) {
    log.Assume(kRateKey, fmt::format("{:.6g}, which the video states", rate_hz));
  }
  const TimeNs start = Start(video, log);
  std::vector<TimeNs> times;
  for (std::size_t i = 0; i < info.frames; ++i) {
    times.push_back(start + std::llround(1e9 * static_cast<double>(i) / rate_hz));
  }
  return times;
}

void CheckSizeOf(const VideoPlan& video, const VideoInfo& info, const CameraCalibration& camera) {
  if (info.width_px == camera.width_px && info.height_px == camera.height_px) return;
  throw InputError::At(
      video.file.string(), 0,
      fmt::format("is {} x {}, expected {} x {} of {}", info.width_px, info.height_px,
                  camera.width_px, camera.height_px, video.camera.string()));
}

}  // namespace

void ReadVideoFile(ImportPlan& plan, Streams& streams, ImportLog& log) {
  VideoPlan& video = *plan.video;
  std::vector<std::string> keys;
  if (video.camera.empty()) keys.push_back("video.camera");
  if (video.collar.empty()) keys.push_back("video.collar");
  if (!keys.empty()) {
    throw NotTold(
        fmt::format("{}: a video does not hold its camera and collar", video.file.string()), keys);
  }
  const VideoInfo info = ReadVideoInfo(video.file);
  CameraStream& camera = streams.recording.cam0.emplace();
  camera.calibration = ReadCameraOf(video, log);
  CheckSizeOf(video, info, camera.calibration);
  ReadLog read_log;
  streams.recording.tags0 = ReadCollarFile(video.collar, read_log);
  for (const auto& warning : read_log.warnings) log.Warn(warning);
  const auto times =
      video.times.file.empty() ? TimesByRate(video, info, log) : TimesFromFile(video, info, log);
  camera.video = video.file.filename().string();
  camera.comment = "frames of " + camera.video;
  std::vector<TimeNs> steps;
  for (std::size_t i = 0; i < times.size(); ++i) {
    camera.frame_numbers.push_back({times[i], static_cast<int>(i)});
    if (i > 0) steps.push_back(times[i] - times[i - 1]);
  }
  if (!steps.empty()) camera.calibration.rate_hz = 1e9 / static_cast<double>(Median(steps));
  streams.files.emplace_back(Whole(video.file), fs::path("cam0") / camera.video);
  for (fs::path* file :
       {&video.file, &video.camera, &video.collar, &video.pose, &video.times.file}) {
    *file = Whole(*file);
  }
}

}  // namespace flextip::exchange
