#include "recording/frames/track_input.h"

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

/// Opens both cameras where both have frames. The two frames of a pair are at most half a period of
/// the faster camera apart.
std::unique_ptr<FrameSets> OpenCameras(const std::filesystem::path& source, const GreyRange& range,
                                       Recording& recording) {
  const auto open = [&](const char* name, const CameraStream& camera) {
    return OpenRecordedFrames(source, name, camera, range);
  };
  auto cam0 = open("cam0", *recording.cam0);
  if (recording.cam1 && TimesOf(*recording.cam1).empty()) recording.cam1.reset();
  if (!recording.cam1) return std::make_unique<FrameSets>(std::move(cam0));
  const double rate_hz =
      std::max(recording.cam0->calibration.rate_hz, recording.cam1->calibration.rate_hz);
  const TimeNs tolerance_ns = rate_hz > 0 ? std::llround(0.5e9 / rate_hz) : 0;
  auto pairs = PairFrames(TimesOf(*recording.cam0), TimesOf(*recording.cam1), tolerance_ns);
  return std::make_unique<FrameSets>(std::move(cam0), open("cam1", *recording.cam1),
                                     std::move(pairs));
}

/// One camera of unknown pose gives tips in its own frame; a second camera must be placed.
void RefuseUnplacedPair(const std::filesystem::path& source, const Recording& recording) {
  if (!recording.cam1 || (recording.cam0->has_T_RC && recording.cam1->has_T_RC)) return;
  const char* name = recording.cam0->has_T_RC ? "cam1" : "cam0";
  throw InputError::At((source / name / "sensor.yaml").string(), 0,
                       "T_RC is unknown, and two cameras give one tip where both are known: find "
                       "it by flextip calibrate hand-eye and give it with --calibration");
}

/// Reads camera and collar; the frames are opened by the caller.
TrackInput ReadCameraFiles(const CameraFiles& files, const TrackInputOptions& options) {
  TrackInput input;
  ReadLog log;
  CameraStream& camera = input.recording.cam0.emplace();
  const auto format = GuessCameraFormat(files.camera);
  const CameraDescription description = ReadCameraDescription(files.camera, format);
  camera.calibration = description.calibration;
  camera.has_T_RC = description.has_T_RC;
  input.recording.tags0 = ReadCollarFile(files.collar, log);
  if (files.rate_hz) camera.calibration.rate_hz = *files.rate_hz;
  input.warnings = std::move(log.warnings);
  input.calibrations = ApplyCalibrations(options.calibrations, input.recording, input.warnings);
  return input;
}

}  // namespace

TrackInput OpenRecordingToTrack(const std::filesystem::path& recording,
                                const TrackInputOptions& options) {
  ReadResult read = ReadRecording(recording);
  const auto refuse = [&](const char* what) { throw InputError::At(recording.string(), 0, what); };
  if (!read.recording.cam0) refuse("no cam0/, tracking needs it");
  if (!read.recording.tags0) refuse("no tags0/, tracking needs it");
  TrackInput input{std::move(read.recording), nullptr, std::move(read.warnings), {}};
  input.recording.vision0.reset();  // found anew
  input.calibrations = ApplyCalibrations(options.calibrations, input.recording, input.warnings);
  RefuseUnplacedPair(recording, input.recording);
  if (!input.recording.cam0->has_T_RC && input.recording.wrist0) {
    input.recording.wrist0.reset();  // in R, which the camera does not know
    input.warnings.emplace_back("cam0: T_RC is unknown: wrist0 does not help to track");
  }
  input.frames = OpenCameras(recording, options.range, input.recording);
  return input;
}

TrackInput OpenPicturesToTrack(const std::filesystem::path& source, const CameraFiles& files,
                               const TrackInputOptions& options) {
  TrackInput input = ReadCameraFiles(files, options);
  input.frames = std::make_unique<FrameSets>(
      OpenPlainFrames(source, input.recording.cam0->calibration, files.rate_hz, options.range));
  return input;
}

TrackInput OpenCameraToTrack(const std::string& source, const CameraFiles& files,
                             const TrackInputOptions& options) {
  TrackInput input = ReadCameraFiles(files, options);
  input.frames =
      std::make_unique<FrameSets>(OpenLiveFrames(source, input.recording.cam0->calibration));
  return input;
}

}  // namespace flextip
