#include "recording/cameras/camera_file.h"

#include <algorithm>

#include "core/check.h"
#include "recording/cameras/yaml.h"
#include "recording/streams/sensor_head.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

struct ModelName {
  const char* name;
  Distortion distortion;
  std::vector<std::size_t> counts;
  const char* expected;
};
const std::vector<ModelName> kModels = {
    {"radial-tangential", Distortion::kRadialTangential, {4}, "4 (k1, k2, p1, p2)"},
    {"opencv", Distortion::kOpenCv, {5, 8, 12}, "5, 8 or 12"},
    {"equidistant", Distortion::kEquidistant, {4}, "4 (k1, k2, k3, k4)"},
};

void ReadResolution(const YamlMap& yaml, CameraCalibration& camera) {
  const auto size = yaml.Numbers("resolution", 2);
  for (const double side : size) {
    if (side != static_cast<int>(side) || side < 1 || side > 100'000) {
      throw yaml.Error("resolution", fmt::format("found [{}, {}], expected a width and a height "
                                                 "in whole pixels",
                                                 size[0], size[1]));
    }
  }
  if (size[0] * size[1] > kMostPixels) {
    throw yaml.Error("resolution", fmt::format("found {} x {}, expected at most {:g} pixels",
                                               size[0], size[1], kMostPixels));
  }
  camera.width_px = static_cast<int>(size[0]);
  camera.height_px = static_cast<int>(size[1]);
}

void ReadIntrinsics(const YamlMap& yaml, CameraCalibration& camera) {
  const auto k = yaml.Numbers("intrinsics", 4);
  if (k[0] <= 0 || k[1] <= 0) {
    throw yaml.Error("intrinsics",
                     fmt::format("found fu {} and fv {}, expected both above 0", k[0], k[1]));
  }
  if (k[2] < 0 || k[2] > camera.width_px || k[3] < 0 || k[3] > camera.height_px) {
    throw yaml.Error("intrinsics", fmt::format("found the principal point {}, {}, expected it "
                                               "inside the image of {} x {}",
                                               k[2], k[3], camera.width_px, camera.height_px));
  }
  camera.fu_px = k[0];
  camera.fv_px = k[1];
  camera.cu_px = k[2];
  camera.cv_px = k[3];
}

void ReadDistortion(const YamlMap& yaml, CameraCalibration& camera) {
  const std::string name = yaml.Text("distortion_model");
  camera.distortion_coefficients = yaml.Numbers("distortion_coefficients");
  const auto model = DistortionOf(name, camera.distortion_coefficients.size());
  if (!model.distortion) throw yaml.Error(model.wrong_key, model.expected);
  camera.distortion = *model.distortion;
}

}  // namespace

NamedDistortion DistortionOf(const std::string& name, std::size_t coefficients) {
  const auto model = std::find_if(kModels.begin(), kModels.end(), [&](const ModelName& candidate) {
    return name == candidate.name;
  });
  if (model == kModels.end()) {
    return {
        {},
        "distortion_model",
        fmt::format("found {}, expected radial-tangential, opencv or equidistant", Quoted(name))};
  }
  if (std::find(model->counts.begin(), model->counts.end(), coefficients) == model->counts.end()) {
    return {{},
            "distortion_coefficients",
            fmt::format("found {} coefficients, expected {} for the model {}", coefficients,
                        model->expected, name)};
  }
  return {model->distortion, "", ""};
}

std::string DistortionName(Distortion distortion) {
  const auto model = std::find_if(kModels.begin(), kModels.end(), [&](const ModelName& candidate) {
    return candidate.distortion == distortion;
  });
  FLEXTIP_CHECK(model != kModels.end(), "a known distortion model");
  return model->name;
}

bool StatesPose(const YamlMap& yaml) {
  return yaml.Has("T_RC") && !(yaml.IsText("T_RC") && yaml.Text("T_RC") == "unknown");
}

CameraCalibration ReadCalibrationKeys(const YamlMap& yaml) {
  CameraCalibration camera;
  (void)yaml.Has("sensor_type");
  for (const char* label : {"comment", "camera_name", "rostopic"}) (void)yaml.Has(label);
  if (const auto model = yaml.Text("camera_model"); model != "pinhole") {
    throw yaml.Error("camera_model", fmt::format("found {}, expected pinhole", Quoted(model)));
  }
  ReadResolution(yaml, camera);
  ReadIntrinsics(yaml, camera);
  ReadDistortion(yaml, camera);
  if (yaml.Has("gamma")) camera.gamma = yaml.Positive("gamma");
  if (StatesPose(yaml)) camera.T_RC = yaml.Transform("T_RC");
  if (yaml.Has("rate_hz")) camera.rate_hz = yaml.Positive("rate_hz");
  return camera;
}

CameraCalibration ReadCameraCalibration(const std::filesystem::path& file, ReadLog* log) {
  const auto yaml = YamlMap::Load(file);
  const CameraCalibration camera = ReadCalibrationKeys(yaml);
  (void)yaml.Has("video");
  if (log) yaml.WarnUnknown(*log);
  return camera;
}

std::string LensText(const CameraCalibration& camera) {
  std::string text = fmt::format("resolution: [{}, {}]\n", camera.width_px, camera.height_px);
  text += "camera_model: pinhole\n";
  text += fmt::format("intrinsics: {}\n",
                      YamlNumbers({camera.fu_px, camera.fv_px, camera.cu_px, camera.cv_px}));
  text += fmt::format("distortion_model: {}\n", DistortionName(camera.distortion));
  text += fmt::format("distortion_coefficients: {}\n", YamlNumbers(camera.distortion_coefficients));
  if (camera.gamma) text += fmt::format("gamma: {}\n", YamlNumber(*camera.gamma));
  return text;
}

std::string CameraText(const CameraCalibration& camera, const std::string& comment,
                       const std::string& pose) {
  return HeadText("camera", comment, camera.rate_hz) + LensText(camera) +
         fmt::format("T_RC: {}\n", pose);
}

void WriteCameraCalibration(const std::filesystem::path& file, const CameraCalibration& calibration,
                            const std::string& comment) {
  WriteTextFile(file, CameraText(calibration, comment, YamlTransform(calibration.T_RC)));
}

}  // namespace flextip
