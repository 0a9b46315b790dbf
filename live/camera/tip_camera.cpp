#include "live/camera/tip_camera.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "live/streams/streams.h"
#include "recording/frames/frame_source.h"

namespace flextip::live {
namespace {

constexpr TimeNs kKept_ns = 1'000'000'000;

}  // namespace

TipCamera::TipCamera(const Session& session, Tip tip, Event event, Seen seen)
    : session_(session),
      tip_(std::move(tip)),
      event_(std::move(event)),
      seen_(std::move(seen)),
      tracker_(TrackerSetupOf(session.base)) {
  if (!session.robot.lockstep) {
    looks_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
  }
  if (!session.camera->video.empty()) {
    video_ = std::jthread([this](const std::stop_token& stop) { RunVideo(stop); });
  }
}

TipCamera::~TipCamera() {
  video_ = {};  // stopped and joined while the other still takes pictures
  looks_ = {};
}

void TipCamera::Take(TimeNs t_ns, Image image, TimeNs arrived_ns) {
  if (!Fits(image)) return;
  Picture picture{session_.camera->TimeOf(t_ns), arrived_ns, std::move(image)};
  if (session_.robot.lockstep) return Look(picture);
  {
    const std::lock_guard lock(mutex_);
    counts_.left_out += newest_.has_value();
    newest_ = std::move(picture);
  }
  changed_.notify_one();
}

/// Counts the picture; says so where it is of another size than the camera's.
bool TipCamera::Fits(const Image& image) {
  const CameraCalibration& camera = session_.base.cam0->calibration;
  const std::lock_guard lock(mutex_);
  ++counts_.pictures;
  if (image.width_px == camera.width_px && image.height_px == camera.height_px) return true;
  if (counts_.refused++ == 0) {
    event_(fmt::format("cam0: a picture of {} x {}, expected {} x {}", image.width_px,
                       image.height_px, camera.width_px, camera.height_px));
  }
  return false;
}

void TipCamera::Note(StreamName stream, const Arrived<AnySample>& sample) {
  if (stream == StreamName::kTip) return;
  const std::lock_guard lock(mutex_);
  auto& samples = samples_[static_cast<std::size_t>(stream)];
  samples.push_back(sample);
  while (samples.front().t_ns < sample.t_ns - kKept_ns) samples.pop_front();
}

CameraCounts TipCamera::Counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void TipCamera::Run(const std::stop_token& stop) {
  while (true) {
    std::optional<Picture> picture;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [&] { return newest_.has_value(); })) return;
      picture = std::exchange(newest_, std::nullopt);
    }
    Look(*picture);
  }
}

void TipCamera::RunVideo(const std::stop_token& stop) {
  try {
    const auto frames = OpenLiveFrames(session_.camera->video, session_.base.cam0->calibration);
    while (!stop.stop_requested()) {
      std::optional<Frame> frame = frames->Next();
      if (!frame) break;
      Take(frame->t_ns, std::move(frame->image), Now_ns());
    }
    if (!stop.stop_requested()) event_("cam0: the video has ended");
  } catch (const std::exception& error) {
    event_(fmt::format("cam0: {}", error.what()));
  }
}

/// The last samples that are not younger than the picture.
SensorReadings TipCamera::ReadingsAt(TimeNs t_ns) {
  const std::lock_guard lock(mutex_);
  const auto last = [&](StreamName stream) -> const Arrived<AnySample>* {
    const auto& samples = samples_[static_cast<std::size_t>(stream)];
    for (auto sample = samples.rbegin(); sample != samples.rend(); ++sample) {
      if (sample->t_ns <= t_ns) return &*sample;
    }
    return nullptr;
  };
  const Recording& base = session_.base;
  SensorReadings readings;
  if (const auto* s = last(StreamName::kWrist); s && base.wrist0)
    readings.wrist = {s->t_ns, Measured(*base.wrist0, std::get<WristSample>(s->value))};
  if (const auto* s = last(StreamName::kEm0); s && base.em0)
    readings.em0 = {s->t_ns, Measured(*base.em0, std::get<EmSample>(s->value))};
  if (const auto* s = last(StreamName::kEm1); s && base.em1)
    readings.em1 = {s->t_ns, Measured(*base.em1, std::get<EmSample>(s->value))};
  if (const auto* s = last(StreamName::kStrain); s && base.strain0)
    readings.strain = {s->t_ns, Measured(*base.strain0, std::get<Eigen::Vector4d>(s->value))};
  if (const auto* s = last(StreamName::kLoad); s && base.load0)
    readings.load = {s->t_ns, Measured(*base.load0, std::get<Eigen::Vector3d>(s->value))};
  return readings;
}

void TipCamera::Look(const Picture& picture) {
  const Image* const pictures[] = {&picture.image};
  const TipTrack track = tracker_.Follow(pictures, picture.t_ns, ReadingsAt(picture.t_ns));
  if (track.tip.status == TipStatus::kOk) {  // without a tip that was seen, it becomes stale
    tip_(picture.t_ns, {track.tip, track.direction_noise_rad}, picture.arrived_ns);
    const std::lock_guard lock(mutex_);
    ++counts_.seen;
  }
  if (seen_) seen_(picture.t_ns, picture.image, track);
}

}  // namespace flextip::live
