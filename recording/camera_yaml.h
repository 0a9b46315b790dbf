// The calibration's keys inside a camera's sensor.yaml, for camera_file and camera_stream.
#pragma once

#include <string>

#include "core/camera.h"
#include "recording/yaml_map.h"

namespace flextip {

CameraCalibration ReadCalibrationKeys(const YamlMap& yaml);

std::string CameraText(const CameraCalibration& calibration, const std::string& comment);
/// Of that the resolution, the lens and gamma.
std::string LensText(const CameraCalibration& calibration);

}  // namespace flextip
