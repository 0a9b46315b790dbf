#include "exchange/formats/camera.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/median.h"
#include "exchange/values/times.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/bounds.h"
#include "recording/text/yaml_map.h"

namespace flextip::exchange {
namespace {

// A file with T_RC, or a calibration.yaml that found it.
Pose ReadPose(const std::filesystem::path& file, const std::string& camera) {
  const auto yaml = YamlMap::Load(file);
  if (yaml.Has("T_RC")) return yaml.Transform("T_RC");
  if (yaml.Has("found")) return yaml.Map("found").Transform(camera + ".T_RC");
  throw yaml.Error("T_RC", fmt::format("found neither T_RC nor found: {}.T_RC, expected the "
                                       "camera's pose",
                                       camera));
}

}  // namespace

CameraStream PlaceCamera(const std::string& name, const CameraPlan& plan,
                         const CameraDescription& camera, ImportLog& log) {
  CameraStream stream;
  stream.calibration = camera.calibration;
  stream.has_T_RC = camera.has_T_RC;
  if (!plan.pose.empty()) {
    stream.calibration.T_RC = ReadPose(plan.pose, name);
    stream.has_T_RC = true;
  }
  if (!stream.has_T_RC) {
    log.Warn(
        fmt::format("{}: no file says where the camera is in R, so its T_RC is unknown: find "
                    "it by flextip calibrate hand-eye",
                    name));
  }
  for (const auto& loss : camera.not_kept) {
    log.Warn(fmt::format("{}: not kept: {}", plan.camera.string(), loss.what));
  }
  return stream;
}

CameraStream ReadCameraOf(const std::string& name, const CameraPlan& plan, int width_px,
                          int height_px, ImportLog& log) {
  const CameraFormat format = GuessCameraFormat(plan.camera);
  CameraFileChoice choice{{}, width_px, height_px};
  if (format == CameraFormat::kKalibr) choice.camera = name;
  const CameraDescription camera = ReadCameraDescription(plan.camera, format, choice);
  const CameraCalibration& c = camera.calibration;
  if (c.width_px != width_px || c.height_px != height_px) {
    throw InputError::At(plan.camera.string(), 0,
                         fmt::format("is of {} x {} pixels, expected {} x {} as the frames of {}",
                                     c.width_px, c.height_px, width_px, height_px, name));
  }
  return PlaceCamera(name, plan, camera, log);
}

void TakeFrameRate(CameraStream& camera) {
  std::vector<TimeNs> steps;
  const auto add = [&](const auto& frames) {
    std::vector<TimeNs> times;
    times.reserve(frames.size());
    for (const auto& frame : frames) times.push_back(frame.t_ns);
    RefuseLeaps("the pictures", times);
    for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  };
  add(camera.frame_numbers);
  add(camera.filenames);
  if (steps.empty()) return;
  const double rate_hz = 1e9 / static_cast<double>(Median(steps));
  const std::string expected = ExpectedAbove(BoundsOf("rate_hz"), rate_hz, false);
  if (!expected.empty()) {
    throw InputError(fmt::format("the pictures are {:.3g} s apart, expected a rate of {}",
                                 1.0 / rate_hz, expected));
  }
  camera.calibration.rate_hz = rate_hz;
}

void ReadCollar(ImportPlan& plan, Recording& recording, ImportLog& log) {
  if (plan.collar.empty()) return;
  ReadLog read_log;
  recording.tags0 = ReadCollarFile(plan.collar, read_log);
  for (const auto& warning : read_log.warnings) log.Warn(warning);
  plan.collar = std::filesystem::absolute(plan.collar).lexically_normal();
}

}  // namespace flextip::exchange
