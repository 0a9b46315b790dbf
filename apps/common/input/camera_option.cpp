#include "apps/common/input/camera_option.h"

#include "recording/cameras/camera_formats.h"

namespace flextip {

void AddCameraOption(CLI::App& command, CameraOption& option) {
  auto* file = command.add_option("--camera", option.file,
                                  "Camera file (EuRoC, Kalibr, ROS or OpenCV) for the accuracy");
  command.add_option("--focal", option.focal_px, "Focal length in px, without a camera file")
      ->capture_default_str()
      ->check(CLI::Range(10.0, 1e5))
      ->excludes(file)
      ->type_name("PX");
  command.add_option("--resolution", option.resolution_px, "Picture in px, without a camera file")
      ->expected(2)
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(16, 100'000))
      ->type_name("W,H");
}

CameraCalibration ReadCamera(const CameraOption& option) {
  if (!option.file.empty()) {
    return ReadCameraDescription(option.file, GuessCameraFormat(option.file)).calibration;
  }
  CameraCalibration camera;
  camera.width_px = option.resolution_px[0];
  camera.height_px = option.resolution_px[1];
  camera.fu_px = camera.fv_px = option.focal_px;
  camera.cu_px = 0.5 * (camera.width_px - 1);
  camera.cv_px = 0.5 * (camera.height_px - 1);
  return camera;
}

}  // namespace flextip
