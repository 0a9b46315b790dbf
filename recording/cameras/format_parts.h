// What the readers and writers of camera files share, one pair for each foreign format.
#pragma once

#include <string>
#include <vector>

#include "recording/cameras/camera_formats.h"
#include "recording/text/yaml_map.h"

namespace flextip {

CameraDescription ReadKalibr(const std::filesystem::path& file, const CameraFileChoice& choice);
std::string KalibrText(const CameraDescription& description);

CameraDescription ReadRosCamera(const std::filesystem::path& file);
std::string RosCameraText(const CameraDescription& description);

CameraDescription ReadOpenCvCamera(const std::filesystem::path& file,
                                   const CameraFileChoice& choice);
void WriteOpenCvCamera(const std::filesystem::path& file, const CameraDescription& description);

/// The lens of ROS's CameraInfo; `problem` (empty: none) says what is wrong with `wrong_key`.
struct RosLens {
  Distortion distortion = Distortion::kRadialTangential;
  std::vector<double> coefficients;
  std::string wrong_key, problem;
};
RosLens RosLensOf(const std::string& model, std::vector<double> coefficients);

/// The coefficients of `camera` as a list of one of the lengths in `counts`, each a form of k1 k2
/// p1 p2 k3 k4 k5 k6 s1 s2 s3 s4: zeros are added or, where that is exact, taken away. Empty where
/// none is exact.
std::optional<std::vector<double>> AsOpenCvTerms(const CameraCalibration& camera,
                                                 const std::vector<std::size_t>& counts);

/// A 3x3 matrix of intrinsics, row by row; returns what is wrong with it, empty for nothing.
std::string TakeIntrinsics(const std::vector<double>& K, CameraCalibration& camera);

/// Exact, and a float to every YAML reader: PyYAML takes 1e-05 for a text and 1 for an integer.
std::string FloatText(double value);
std::string FloatsText(const std::vector<double>& values);

/// comment, camera_name, rostopic and the rate as keys that other programs pass over, each line
/// after `indent`.
std::string LabelText(const CameraDescription& description, const std::string& indent);
void ReadLabels(const YamlMap& yaml, CameraDescription& description);

/// Keys that nobody asked for, as losses.
void AddUnasked(const YamlMap& yaml, CameraDescription& description);

}  // namespace flextip
