// A camera's sensor.yaml, alone or in a recording's cam0/.
#pragma once

#include <filesystem>
#include <string>

#include "core/camera.h"
#include "recording/read_log.h"

namespace flextip {

/// Reads a camera's sensor.yaml (docs/formats.md). Throws InputError with file and line for missing
/// keys, an unknown camera or distortion model, a wrong number of intrinsics or distortion
/// coefficients, a principal point outside the image, and a T_RC that is no rigid transform.
/// `T_RC` and `rate_hz` may be absent here (identity, 30): a camera can be calibrated before it is
/// registered. Unknown keys are reported in `log` where there is one.
CameraCalibration ReadCameraCalibration(const std::filesystem::path& file, ReadLog* log = nullptr);

/// Writes it, every number exact. Throws WorkError where the disk refuses.
void WriteCameraCalibration(const std::filesystem::path& file, const CameraCalibration& calibration,
                            const std::string& comment = "");

}  // namespace flextip
