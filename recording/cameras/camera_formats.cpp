#include "recording/cameras/camera_formats.h"

#include <algorithm>

#include "recording/cameras/format_parts.h"
#include "recording/cameras/yaml.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

bool IsIdentity(const Pose& T) { return T.Matrix().isIdentity(0.0); }

CameraDescription ReadEuroc(const std::filesystem::path& file) {
  const auto yaml = YamlMap::Load(file);
  CameraDescription d;
  d.calibration = ReadCalibrationKeys(yaml);
  d.has_T_RC = StatesPose(yaml);
  (void)yaml.Has("video");  // of the recording
  ReadLabels(yaml, d);
  if (yaml.Has("T_BS")) d.T_BS = yaml.Transform("T_BS");
  AddUnasked(yaml, d);
  return d;
}

std::string EurocText(const CameraDescription& d) {
  std::string text = "sensor_type: camera\n" + LabelText(d, "") + LensText(d.calibration);
  if (d.has_T_RC) text += fmt::format("T_RC: {}\n", YamlTransform(d.calibration.T_RC));
  if (d.T_BS) text += fmt::format("T_BS: {}\n", YamlTransform(*d.T_BS));
  return text;
}

std::optional<CameraLoss> LensLoss(CameraFormat format, const CameraCalibration& c) {
  if (format == CameraFormat::kEuroc || format == CameraFormat::kOpenCv ||
      c.distortion == Distortion::kEquidistant) {
    return {};
  }
  const bool kalibr = format == CameraFormat::kKalibr;
  const std::vector<std::size_t> counts =
      kalibr ? std::vector<std::size_t>{4} : std::vector<std::size_t>{5, 8};
  if (AsOpenCvTerms(c, counts)) return {};
  return CameraLoss{"",
                    fmt::format("the lens with its {} terms ({})", c.distortion_coefficients.size(),
                                kalibr ? "radtan has 4" : "rational_polynomial has 8")};
}

}  // namespace

const char* Name(CameraFormat format) {
  switch (format) {
    case CameraFormat::kEuroc:
      return "euroc";
    case CameraFormat::kKalibr:
      return "kalibr";
    case CameraFormat::kRos:
      return "ros";
    case CameraFormat::kOpenCv:
      return "opencv";
  }
  return "";
}

std::string ProblemOf(const CameraCalibration& c) {
  if (c.width_px < 1 || c.height_px < 1) {
    return fmt::format("found a resolution of {} x {}, expected at least one pixel", c.width_px,
                       c.height_px);
  }
  if (static_cast<double>(c.width_px) * c.height_px > kMostPixels) {
    return fmt::format("found a resolution of {} x {}, expected at most {:g} pixels", c.width_px,
                       c.height_px, kMostPixels);
  }
  if (!(c.fu_px > 0 && c.fv_px > 0)) {
    return fmt::format("found focal lengths {} and {}, expected both above 0", c.fu_px, c.fv_px);
  }
  if (!(c.cu_px >= 0 && c.cu_px <= c.width_px && c.cv_px >= 0 && c.cv_px <= c.height_px)) {
    return fmt::format("found the principal point {}, {}, expected it inside the image of {} x {}",
                       c.cu_px, c.cv_px, c.width_px, c.height_px);
  }
  const auto beyond = [](const char* name, double value) -> std::string {
    const std::string expected = ExpectedWithin(BoundsOf(name), value);
    return expected.empty() ? "" : fmt::format("{}: found {}, expected {}", name, value, expected);
  };
  for (const int side_px : {c.width_px, c.height_px}) {
    if (const auto problem = beyond("resolution", side_px); !problem.empty()) return problem;
  }
  for (const double focal_px : {c.fu_px, c.fv_px}) {
    if (const auto problem = beyond("intrinsics", focal_px); !problem.empty()) return problem;
  }
  for (const double term : c.distortion_coefficients) {
    if (const auto problem = beyond("distortion_coefficients", term); !problem.empty())
      return problem;
  }
  return "";
}

CameraFormat GuessCameraFormat(const std::filesystem::path& file) {
  const std::string text = ReadTextFile(file);
  const auto start = Trim(std::string_view(text).substr(0, 200));
  if (start.starts_with("%YAML:1.0") || start.starts_with("<") || start.starts_with("{")) {
    return CameraFormat::kOpenCv;
  }
  const auto yaml = YamlMap::Load(file);
  if (yaml.Has("camera_matrix")) return CameraFormat::kRos;
  if (yaml.Has("intrinsics")) return CameraFormat::kEuroc;
  const auto keys = yaml.Keys();
  if (std::any_of(keys.begin(), keys.end(), [](const auto& k) { return k.starts_with("cam"); })) {
    return CameraFormat::kKalibr;
  }
  throw InputError::At(file.string(), 0,
                       "not a camera file that is known, expected EuRoC's sensor.yaml, a Kalibr "
                       "camchain, ROS camera_info or OpenCV's FileStorage");
}

CameraDescription ReadCameraDescription(const std::filesystem::path& file, CameraFormat format,
                                        const CameraFileChoice& choice) {
  if (!choice.camera.empty() && format != CameraFormat::kKalibr) {
    throw InputError::At(
        file.string(), 0,
        fmt::format("holds one camera only, found {} to be chosen", Quoted(choice.camera)));
  }
  CameraDescription d;
  switch (format) {
    case CameraFormat::kEuroc:
      d = ReadEuroc(file);
      break;
    case CameraFormat::kKalibr:
      d = ReadKalibr(file, choice);
      break;
    case CameraFormat::kRos:
      d = ReadRosCamera(file);
      break;
    case CameraFormat::kOpenCv:
      d = ReadOpenCvCamera(file, choice);
      break;
  }
  if (const auto problem = ProblemOf(d.calibration); !problem.empty())
    throw InputError::At(file.string(), 0, problem);
  return d;
}

std::vector<CameraLoss> LossesIn(CameraFormat format, const CameraDescription& d) {
  std::vector<CameraLoss> losses = d.not_kept;
  if (const auto lens = LensLoss(format, d.calibration)) losses.push_back(*lens);
  if (format == CameraFormat::kEuroc) return losses;
  if (d.calibration.gamma) {
    losses.push_back({"gamma", fmt::format("the gamma of {}", *d.calibration.gamma)});
  }
  if (d.has_T_RC && !IsIdentity(d.calibration.T_RC)) {
    losses.push_back({"pose", "T_RC, the camera's pose in the robot's frame"});
  }
  if (format != CameraFormat::kKalibr && d.T_BS && !IsIdentity(*d.T_BS)) {
    losses.push_back({"pose", "the camera's pose in the body's frame (T_BS, T_cam_imu)"});
  }
  return losses;
}

void WriteCameraDescription(const std::filesystem::path& file, CameraFormat format,
                            const CameraDescription& d) {
  if (const auto lens = LensLoss(format, d.calibration)) {
    throw InputError::At(file.string(), 0,
                         fmt::format("{} has no place for {}", Name(format), lens->what));
  }
  if (format == CameraFormat::kOpenCv) {
    WriteOpenCvCamera(file, d);
    return;
  }
  WriteTextFile(file, format == CameraFormat::kEuroc    ? EurocText(d)
                      : format == CameraFormat::kKalibr ? KalibrText(d)
                                                        : RosCameraText(d));
}

std::optional<std::vector<double>> AsOpenCvTerms(const CameraCalibration& camera,
                                                 const std::vector<std::size_t>& counts) {
  const auto& k = camera.distortion_coefficients;
  for (const std::size_t count : counts) {
    std::vector<double> terms = k;
    terms.resize(std::max(count, k.size()), 0.0);
    const auto beyond = terms.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::any_of(beyond, terms.end(), [](double term) { return term != 0.0; })) continue;
    terms.resize(count);
    return terms;
  }
  return {};
}

std::string TakeIntrinsics(const std::vector<double>& K, CameraCalibration& camera) {
  if (K.size() != 9) return fmt::format("found {} numbers, expected 3 x 3", K.size());
  if (K[1] != 0.0) return fmt::format("found a skew of {}, of which there is no counterpart", K[1]);
  if (K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1) {
    return "expected fu, 0, cu, 0, fv, cv, 0, 0, 1";
  }
  camera.fu_px = K[0], camera.cu_px = K[2], camera.fv_px = K[4], camera.cv_px = K[5];
  return "";
}

std::string FloatText(double value) {
  std::string text = YamlNumber(value);
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

std::string FloatsText(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + FloatText(value);
  return text + "]";
}

std::string LabelText(const CameraDescription& d, const std::string& indent) {
  std::string text;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{}{}: {}\n", indent, key, YamlText(value));
  };
  add("comment", d.comment);
  add("camera_name", d.camera_name);
  add("rostopic", d.rostopic);
  if (d.has_rate) text += fmt::format("{}rate_hz: {}\n", indent, FloatText(d.calibration.rate_hz));
  return text;
}

void ReadLabels(const YamlMap& yaml, CameraDescription& d) {
  d.comment = yaml.TextOr("comment", "");
  d.camera_name = yaml.TextOr("camera_name", "");
  d.rostopic = yaml.TextOr("rostopic", "");
  d.has_rate = yaml.Has("rate_hz");
  if (d.has_rate) d.calibration.rate_hz = yaml.Positive("rate_hz");
}

void AddUnasked(const YamlMap& yaml, CameraDescription& d) {
  for (const auto& key : yaml.Unasked()) d.not_kept.push_back({key, fmt::format("key {}", key)});
}

}  // namespace flextip
