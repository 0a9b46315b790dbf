// Videos with their frames' times, lens and pose as cam0 and cam1, and the collar as tags0.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "exchange/formats/camera.h"
#include "exchange/formats/formats.h"
#include "exchange/formats/side_car.h"
#include "exchange/tables/stream_table.h"
#include "exchange/values/times.h"
#include "recording/frames/video_info.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLostBySideCar = 2;  // frames that a recorder's encoder may swallow

fs::path Whole(const fs::path& file) {
  return file.empty() ? file : fs::absolute(file).lexically_normal();
}

std::string PlanKey(const std::string& camera, const char* key) {
  return fmt::format("cameras.{}.{}", camera, key);
}

TimeNs Shifted(const fs::path& file, TimeNs t_ns, const CameraPlan& plan) {
  const auto sum = WithOffset(t_ns, plan.offset_ns.value_or(0));
  if (sum) return *sum;
  throw InputError::At(file.string(), 0,
                       "the times are beyond what a recording holds, with the offset added");
}

std::vector<TimeNs> TimesFromFile(const std::string& name, CameraPlan& plan, const VideoInfo& info,
                                  ImportLog& log) {
  const bool side_car = IsSideCar(plan.times.file);
  std::vector<TimeNs> times;
  if (side_car) {
    times = ReadSideCar(plan.times.file).t_ns;
    for (TimeNs& t_ns : times) t_ns = Shifted(plan.times.file, t_ns, plan);
  } else {
    plan.times.offset_ns = plan.offset_ns;
    times = ReadStreamRows(name, plan.times, log).t_ns;
    plan.times.offset_ns.reset();
  }
  const std::size_t common = std::min(times.size(), info.frames);
  const std::size_t apart = std::max(times.size(), info.frames) - common;
  if (apart > (side_car ? kMostLostBySideCar : 0)) {
    throw InputError::At(plan.times.file.string(), 0,
                         fmt::format("found {} times, expected {}: {} holds as many frames",
                                     times.size(), info.frames, plan.video.string()));
  }
  if (apart > 0) {
    log.Warn(fmt::format("{}: {} times for {} frames: the first {} of both are taken for pairs",
                         name, times.size(), info.frames, common));
  }
  times.resize(common);
  return times;
}

TimeNs Start(const std::string& name, CameraPlan& plan, bool alone, ImportLog& log) {
  if (plan.start.empty()) {
    if (!alone) {
      throw NotTold(fmt::format("{}: no file says when the first frame of {} was taken, and other "
                                "streams have clocks",
                                name, plan.video.string()),
                    {PlanKey(name, "start"), PlanKey(name, "times")});
    }
    plan.start = "0";
    log.Assume(name + ".start", "0 s: the first frame's time is not told");
  }
  const auto clock = ParseClock(plan.start);
  const auto t_ns = clock ? clock->t_ns : DecimalTime(plan.start, "s");
  if (!t_ns) {
    throw InputError(fmt::format("{}.start: found {}, expected seconds or 2024-05-01T12:00:00.123",
                                 name, Quoted(plan.start)));
  }
  if (clock && clock->has_date && !clock->has_zone) {
    log.Assume(name + ".clock", "UTC: the start states no zone");
  }
  return Shifted(plan.video, *t_ns, plan);
}

std::vector<TimeNs> TimesByRate(const std::string& name, CameraPlan& plan, const VideoInfo& info,
                                bool alone, ImportLog& log) {
  const double rate_hz = plan.rate_hz.value_or(info.rate_hz);
  if (!(rate_hz > 0 && rate_hz < 1e5)) {
    throw NotTold(fmt::format("{}: {} does not state its rate", name, plan.video.string()),
                  {PlanKey(name, "rate_hz"), PlanKey(name, "times")});
  }
  const TimeNs start = Start(name, plan, alone, log);
  if (!plan.rate_hz) {
    log.Assume(name + ".frame_rate_hz", fmt::format("{:.6g}, which the video states", rate_hz));
  }
  std::vector<TimeNs> times;
  for (std::size_t i = 0; i < info.frames; ++i) {
    times.push_back(start + std::llround(1e9 * static_cast<double>(i) / rate_hz));
  }
  return times;
}

void PutFile(const fs::path& from, const fs::path& to, bool link) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (link) {
    fs::create_symlink(from, to, error);
  } else {
    fs::copy_file(from, to, error);
  }
  if (!error) return;
  throw WorkError(
      fmt::format("{}: cannot be put into the recording: {}", from.string(), error.message()));
}

void ReadVideo(const std::string& name, CameraPlan& plan, bool alone, Streams& streams,
               ImportLog& log) {
  if (plan.camera.empty()) {
    throw NotTold(fmt::format("{}: {} does not hold its lens", name, plan.video.string()),
                  {PlanKey(name, "camera")});
  }
  const VideoInfo info = ReadVideoInfo(plan.video);
  CameraStream camera = ReadCameraOf(name, plan, info.width_px, info.height_px, log);
  const auto times = plan.times.file.empty() ? TimesByRate(name, plan, info, alone, log)
                                             : TimesFromFile(name, plan, info, log);
  camera.video = plan.video.filename().string();
  camera.comment = "frames of " + camera.video;
  for (std::size_t i = 0; i < times.size(); ++i) {
    camera.frame_numbers.push_back({times[i], static_cast<int>(i)});
  }
  TakeFrameRate(camera);
  for (fs::path* file : {&plan.video, &plan.camera, &plan.pose, &plan.times.file}) {
    *file = Whole(*file);
  }
  streams.writers.emplace_back(
      [from = plan.video, to = fs::path(name) / camera.video,
       link = plan.link](const fs::path& folder) { PutFile(from, folder / to, link); });
  (name == "cam0" ? streams.recording.cam0 : streams.recording.cam1) = std::move(camera);
}

}  // namespace

void ReadVideos(ImportPlan& plan, Streams& streams, ImportLog& log) {
  const bool alone = plan.streams.empty() && plan.cameras.size() == 1;
  for (auto& [name, camera] : plan.cameras) {
    if (!camera.topic.empty()) continue;
    if (camera.video.empty()) {
      log.missing.push_back(
          {fmt::format("{}: no video and no topic is told for it", name), {"streams"}});
      continue;
    }
    log.Try([&, &name = name, &camera = camera] { ReadVideo(name, camera, alone, streams, log); });
  }
  ReadCollar(plan, streams.recording, log);
}

}  // namespace flextip::exchange
