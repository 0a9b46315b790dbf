// Camera files of several programs, and what is lost between them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"

namespace flextip {

enum class CameraFormat : std::uint8_t {
  kEuroc,   ///< sensor.yaml, as in recordings
  kKalibr,  ///< camchain.yaml
  kRos,     ///< camera_info, the file of camera_calibration_parsers
  kOpenCv,  ///< cv::FileStorage: YAML, XML or JSON
};
/// "euroc", "kalibr", "ros", "opencv".
const char* Name(CameraFormat format);

/// Something a file says of its camera that another one has no place for.
struct CameraLoss {
  std::string name;  ///< "pose", "gamma" or the file's own key; empty: it cannot be left out (lens)
  std::string what;
};

/// A camera as a file describes it.
struct CameraDescription {
  CameraCalibration calibration;
  bool has_T_RC = false, has_rate = false;  ///< else the calibration has the default
  std::optional<Pose> T_BS;  ///< in the body's frame: EuRoC's T_BS, the inverse of T_cam_imu
  std::string comment, camera_name, rostopic;  ///< carried along in every format
  std::vector<CameraLoss> not_kept;            ///< what is in the file and not in here
  std::vector<std::string> notes;  ///< what was left out and does not matter to a camera
};

/// Returns what no camera has, whatever file or message it is from, as "found ..., expected ...";
/// empty where nothing is wrong. A recording of such a camera could not be read.
std::string ProblemOf(const CameraCalibration& camera);

/// By the file's content. Throws InputError where it looks like none of them.
CameraFormat GuessCameraFormat(const std::filesystem::path& file);

struct CameraFileChoice {
  std::string camera;               ///< of a camchain with several: "cam1"
  int width_px = 0, height_px = 0;  ///< for files that do not state their resolution
};

/// Throws InputError with file, line and key for what is missing or broken, a camera model that is
/// no pinhole, a lens model there is no counterpart of (fov, skew, tilt), a camchain of several
/// cameras of which none was chosen.
CameraDescription ReadCameraDescription(const std::filesystem::path& file, CameraFormat format,
                                        const CameraFileChoice& choice = {});

/// What `description` holds that a file of `format` would not: empty means without loss.
std::vector<CameraLoss> LossesIn(CameraFormat format, const CameraDescription& description);

/// Every number exact; what LossesIn names is left out. Throws InputError where the lens does not
/// fit and WorkError where the disk refuses.
void WriteCameraDescription(const std::filesystem::path& file, CameraFormat format,
                            const CameraDescription& description);

}  // namespace flextip
