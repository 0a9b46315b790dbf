// The calibration's keys inside a camera's sensor.yaml, for camera_file and camera_stream.
#pragma once

#include <optional>
#include <string>

#include "core/camera.h"
#include "recording/text/yaml_map.h"

namespace flextip {

CameraCalibration ReadCalibrationKeys(const YamlMap& yaml);
/// Whether the pose is stated; absent and `T_RC: unknown` state none.
bool StatesPose(const YamlMap& yaml);

/// Of a `distortion_model` and so many `distortion_coefficients`: the lens model, or which of the
/// two is wrong and what was expected.
struct NamedDistortion {
  std::optional<Distortion> distortion;
  std::string wrong_key, expected;
};
NamedDistortion DistortionOf(const std::string& name, std::size_t coefficients);
std::string DistortionName(Distortion distortion);

/// `pose`: T_RC as text.
std::string CameraText(const CameraCalibration& calibration, const std::string& comment,
                       const std::string& pose);
/// Of that the resolution, the lens and gamma.
std::string LensText(const CameraCalibration& calibration);

}  // namespace flextip
