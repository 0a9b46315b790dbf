// ROS camera_info files (camera_calibration_parsers; sensor_msgs/CameraInfo says what they mean).
#include <algorithm>

#include "recording/cameras/format_parts.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

std::vector<double> ReadMatrix(const YamlMap& yaml, const std::string& key, std::int64_t rows,
                               std::int64_t cols) {
  const YamlMap matrix = yaml.Map(key);
  if (matrix.Integer("rows") != rows || matrix.Integer("cols") != cols) {
    throw matrix.Error("rows",
                       fmt::format("found {} x {}, expected {} x {}", matrix.Integer("rows"),
                                   matrix.Integer("cols"), rows, cols));
  }
  return matrix.Numbers("data", static_cast<std::size_t>(rows * cols));
}

void ReadLens(const YamlMap& yaml, CameraCalibration& camera) {
  const std::string model = yaml.Text("distortion_model");
  const YamlMap matrix = yaml.Map("distortion_coefficients");
  (void)matrix.Integer("rows"), (void)matrix.Integer("cols");
  const RosLens lens = RosLensOf(model, matrix.Numbers("data"));
  if (!lens.problem.empty()) throw yaml.Error(lens.wrong_key, lens.problem);
  camera.distortion = lens.distortion;
  camera.distortion_coefficients = lens.coefficients;
}

void ReadRectification(const YamlMap& yaml, const std::vector<double>& K, CameraDescription& d) {
  const std::vector<double> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (yaml.Has("rectification_matrix") &&
      ReadMatrix(yaml, "rectification_matrix", 3, 3) != identity) {
    d.not_kept.push_back({"rectification_matrix", "a rectification_matrix that turns the picture"});
  }
  if (!yaml.Has("projection_matrix")) return;
  const auto P = ReadMatrix(yaml, "projection_matrix", 3, 4);
  if (P[3] != 0 || P[7] != 0 || P[11] != 0) {
    d.not_kept.push_back(
        {"projection_matrix", "a projection_matrix with a stereo baseline in its last column"});
  } else if (std::vector<double>{P[0], P[1], P[2], P[4], P[5], P[6], P[8], P[9], P[10]} != K) {
    d.notes.emplace_back(
        "projection_matrix: how the rectified picture is cut, not the camera's own");
  }
}

void ReadCrop(const YamlMap& yaml, CameraDescription& d) {
  for (const char* key : {"binning_x", "binning_y"}) {
    const auto by = yaml.Has(key) ? yaml.Integer(key) : 0;
    if (by > 1) d.not_kept.push_back({"binning", fmt::format("{} of {}", key, by)});
  }
  if (!yaml.Has("roi")) return;
  const YamlMap roi = yaml.Map("roi");
  const auto keys = roi.Keys();
  const bool set = std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
    const std::string value = roi.Text(key);
    return value != "0" && value != "false" && value != "False";
  });
  if (set) d.not_kept.push_back({"roi", "a region of interest (roi)"});
}

std::string MatrixText(const char* name, int rows, const std::vector<double>& data) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", name, rows,
                     static_cast<int>(data.size()) / rows, FloatsText(data));
}

}  // namespace

RosLens RosLensOf(const std::string& model, std::vector<double> k) {
  RosLens lens;
  const auto take = [&](Distortion distortion, bool fits, const char* counts) {
    lens.distortion = distortion;
    if (fits) return;
    lens.wrong_key = "distortion_coefficients";
    lens.problem = fmt::format("found {}, expected {} for {}", k.size(), counts, model);
  };
  if (model == "plumb_bob") {
    take(Distortion::kOpenCv, k.size() == 4 || k.size() == 5, "4 or 5");
    if (k.size() == 5 && k[4] == 0.0) k.pop_back();  // the same lens
    if (k.size() == 4) lens.distortion = Distortion::kRadialTangential;
  } else if (model == "rational_polynomial") {
    take(Distortion::kOpenCv, k.size() == 8, "8");
  } else if (model == "equidistant") {
    take(Distortion::kEquidistant, k.size() == 4, "4");
  } else {
    lens.wrong_key = "distortion_model";
    lens.problem = fmt::format("found {}, expected plumb_bob, rational_polynomial or equidistant",
                               Quoted(model));
  }
  lens.coefficients = std::move(k);
  return lens;
}

CameraDescription ReadRosCamera(const std::filesystem::path& file) {
  const auto yaml = YamlMap::Load(file);
  CameraDescription d;
  d.calibration.width_px = static_cast<int>(yaml.Integer("image_width"));
  d.calibration.height_px = static_cast<int>(yaml.Integer("image_height"));
  const auto K = ReadMatrix(yaml, "camera_matrix", 3, 3);
  if (const auto problem = TakeIntrinsics(K, d.calibration); !problem.empty()) {
    throw yaml.Error("camera_matrix", problem);
  }
  ReadLens(yaml, d.calibration);
  ReadRectification(yaml, K, d);
  ReadCrop(yaml, d);
  ReadLabels(yaml, d);
  AddUnasked(yaml, d);
  return d;
}

std::string RosCameraText(const CameraDescription& d) {
  const CameraCalibration& c = d.calibration;
  const bool fisheye = c.distortion == Distortion::kEquidistant;
  const auto terms = fisheye ? c.distortion_coefficients : *AsOpenCvTerms(c, {5, 8});
  const char* model = fisheye             ? "equidistant"
                      : terms.size() == 5 ? "plumb_bob"
                                          : "rational_polynomial";
  std::string text = fmt::format("image_width: {}\nimage_height: {}\n", c.width_px, c.height_px);
  if (d.camera_name.empty()) text += "camera_name: camera\n";  // readers insist on one
  text += MatrixText("camera_matrix", 3, {c.fu_px, 0, c.cu_px, 0, c.fv_px, c.cv_px, 0, 0, 1});
  text += fmt::format("distortion_model: {}\n", model);
  text += MatrixText("distortion_coefficients", 1, terms);
  text += MatrixText("rectification_matrix", 3, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  text += MatrixText("projection_matrix", 3,
                     {c.fu_px, 0, c.cu_px, 0, 0, c.fv_px, c.cv_px, 0, 0, 0, 1, 0});
  return text + LabelText(d, "");
}

}  // namespace flextip
