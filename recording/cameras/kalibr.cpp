// Kalibr's camchain.yaml (github.com/ethz-asl/kalibr, wiki "Yaml formats").
#include "recording/cameras/format_parts.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

std::string ChooseCamera(const YamlMap& chain, const std::string& wanted) {
  std::vector<std::string> names;
  for (const auto& key : chain.Keys()) {
    if (key.starts_with("cam")) names.push_back(key);
  }
  if (!wanted.empty()) {
    if (!chain.Has(wanted)) throw chain.Error(wanted, "no such camera in the file");
    return wanted;
  }
  if (names.size() == 1) return names.front();
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + name;
  throw chain.Error(
      names.empty() ? "cam0" : names.front(),
      fmt::format("found {} cameras ({}), expected the name of one of them", names.size(), list));
}

void ReadLens(const YamlMap& cam, CameraCalibration& camera) {
  if (const auto model = cam.Text("camera_model"); model != "pinhole") {
    throw cam.Error("camera_model", fmt::format("found {}, expected pinhole: there is no "
                                                "counterpart of other models",
                                                Quoted(model)));
  }
  const auto k = cam.Numbers("intrinsics", 4);
  camera.fu_px = k[0], camera.fv_px = k[1], camera.cu_px = k[2], camera.cv_px = k[3];
  const std::string model = cam.Text("distortion_model");
  if (model == "none") {
    (void)cam.Has("distortion_coeffs");
    camera.distortion_coefficients = {0, 0, 0, 0};
  } else if (model == "radtan" || model == "equidistant") {
    camera.distortion =
        model == "radtan" ? Distortion::kRadialTangential : Distortion::kEquidistant;
    camera.distortion_coefficients = cam.Numbers("distortion_coeffs", 4);
  } else {
    throw cam.Error("distortion_model", fmt::format("found {}, expected radtan, equidistant or "
                                                    "none: there is no counterpart of other models",
                                                    Quoted(model)));
  }
}

std::string RowsText(const Pose& T, const std::string& indent) {
  const Eigen::Matrix4d m = T.Matrix();
  std::string text;
  for (int row = 0; row < 4; ++row) {
    text += indent + "- " + FloatsText({m(row, 0), m(row, 1), m(row, 2), m(row, 3)}) + "\n";
  }
  return text;
}

}  // namespace

CameraDescription ReadKalibr(const std::filesystem::path& file, const CameraFileChoice& choice) {
  const auto chain = YamlMap::Load(file);
  const YamlMap cam = chain.Map(ChooseCamera(chain, choice.camera));
  CameraDescription d;
  ReadLens(cam, d.calibration);
  const auto size = cam.Numbers("resolution", 2);
  d.calibration.width_px = static_cast<int>(size[0]);
  d.calibration.height_px = static_cast<int>(size[1]);
  ReadLabels(cam, d);
  (void)cam.Has("cam_overlaps");  // which cameras see the same: of the chain, not of this one
  if (cam.Has("T_cam_imu")) d.T_BS = cam.TransformRows("T_cam_imu").Inverse();
  if (cam.NumberOr("timeshift_cam_imu", 0.0) != 0.0) {
    d.not_kept.push_back({"timeshift_cam_imu", fmt::format("timeshift_cam_imu of {} s",
                                                           cam.Number("timeshift_cam_imu"))});
  }
  if (cam.Has("T_cn_cnm1")) {
    d.not_kept.push_back({"pose", "T_cn_cnm1, the pose to the camera before it in the chain"});
  }
  AddUnasked(cam, d);
  return d;
}

std::string KalibrText(const CameraDescription& d) {
  const CameraCalibration& c = d.calibration;
  const bool fisheye = c.distortion == Distortion::kEquidistant;
  const auto terms = fisheye ? c.distortion_coefficients : *AsOpenCvTerms(c, {4});
  std::string text = "cam0:\n  camera_model: pinhole\n";
  text += fmt::format("  intrinsics: {}\n", FloatsText({c.fu_px, c.fv_px, c.cu_px, c.cv_px}));
  text += fmt::format("  distortion_model: {}\n", fisheye ? "equidistant" : "radtan");
  text += fmt::format("  distortion_coeffs: {}\n", FloatsText(terms));
  text += fmt::format("  resolution: [{}, {}]\n", c.width_px, c.height_px);
  if (d.T_BS) text += "  T_cam_imu:\n" + RowsText(d.T_BS->Inverse(), "  ");
  return text + LabelText(d, "  ");
}

}  // namespace flextip
