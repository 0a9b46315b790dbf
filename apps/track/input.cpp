#include "apps/track/input.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "recording/cameras/camera_formats.h"
#include "recording/recording_reader.h"
#include "recording/streams/sensor_streams.h"

namespace flextip {
namespace {

std::vector<TimeNs> TimesOf(const CameraStream& camera) {
  std::vector<TimeNs> times;
  for (const auto& frame : camera.filenames) times.push_back(frame.t_ns);
  for (const auto& frame : camera.frame_numbers) times.push_back(frame.t_ns);
  return times;
}

// Both cameras where both have frames; a pair is at most half a period of the faster one apart.
void OpenCameras(const TrackInputOptions& options, TrackInput& input) {
  Recording& recording = input.recording;
  const auto open = [&](const char* name, const CameraStream& camera) {
    return OpenRecordedFrames(options.source, name, camera, options.range);
  };
  auto cam0 = open("cam0", *recording.cam0);
  if (recording.cam1 && TimesOf(*recording.cam1).empty()) recording.cam1.reset();
  if (!recording.cam1) {
    input.frames = std::make_unique<FrameSets>(std::move(cam0));
    return;
  }
  const double rate_hz =
      std::max(recording.cam0->calibration.rate_hz, recording.cam1->calibration.rate_hz);
  const TimeNs tolerance_ns = rate_hz > 0 ? std::llround(0.5e9 / rate_hz) : 0;
  auto pairs = PairFrames(TimesOf(*recording.cam0), TimesOf(*recording.cam1), tolerance_ns);
  input.frames =
      std::make_unique<FrameSets>(std::move(cam0), open("cam1", *recording.cam1), std::move(pairs));
}

TrackInput OpenRecording(const TrackInputOptions& options) {
  const auto& source = options.source;
  const auto refuse = [&](const std::string& what) {
    throw InputError::At(source.string(), 0, what);
  };
  if (!options.camera.empty() || !options.collar.empty() || options.rate_hz) {
    refuse(
        "a recording has its own camera, collar and times: --camera, --collar and --rate are "
        "for plain pictures and videos");
  }
  ReadResult read = ReadRecording(source);
  if (!read.recording.cam0) refuse("no cam0/, tracking needs it");
  if (!read.recording.tags0) refuse("no tags0/, tracking needs it");
  TrackInput input{std::move(read.recording), true, nullptr, std::move(read.warnings), {}};
  input.recording.vision0.reset();  // found anew
  input.calibrations = UseCalibrations(options.calibrations, input.recording, input.warnings);
  OpenCameras(options, input);
  return input;
}

}  // namespace

TrackInput OpenTrackInput(const TrackInputOptions& options) {
  const bool live = !options.live.empty();
  if (live == !options.source.empty()) {
    throw InputError(live ? "track: found a recording and --live, expected one of them"
                          : "track: expected a recording, pictures, a video or --live SOURCE");
  }
  const bool plain =
      live || std::filesystem::is_regular_file(options.source) ||
      (!options.camera.empty() && !std::filesystem::exists(options.source / "recording.yaml"));
  if (!plain) return OpenRecording(options);
  if (options.camera.empty() || options.collar.empty()) {
    throw InputError::At(live ? options.live : options.source.string(), 0,
                         "is no recording, expected --camera FILE and --collar FILE with it");
  }
  TrackInput input;
  ReadLog log;
  CameraStream& camera = input.recording.cam0.emplace();
  const auto format = GuessCameraFormat(options.camera);
  camera.calibration = ReadCameraDescription(options.camera, format).calibration;
  input.recording.tags0 = ReadCollarFile(options.collar, log);
  if (options.rate_hz) camera.calibration.rate_hz = *options.rate_hz;
  input.warnings = std::move(log.warnings);
  input.calibrations = UseCalibrations(options.calibrations, input.recording, input.warnings);
  input.frames = std::make_unique<FrameSets>(
      live ? OpenLiveFrames(options.live, camera.calibration)
           : OpenPlainFrames(options.source, camera.calibration, options.rate_hz, options.range));
  return input;
}

}  // namespace flextip
