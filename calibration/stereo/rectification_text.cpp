#include "calibration/stereo/rectification_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace flextip {
namespace {

template <class Matrix>
std::vector<double> RowByRow(const Matrix& m) {
  std::vector<double> values;
  for (Eigen::Index row = 0; row < m.rows(); ++row) {
    for (Eigen::Index column = 0; column < m.cols(); ++column) values.push_back(m(row, column));
  }
  return values;
}

template <class Matrix>
std::string OpenCvMatrix(const std::string& name, const Matrix& m) {
  return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     name, m.rows(), m.cols(), fmt::join(RowByRow(m), ", "));
}

template <class Matrix>
std::string RosMatrix(const std::string& name, const Matrix& m) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, m.rows(), m.cols(),
                     fmt::join(RowByRow(m), ", "));
}

Eigen::Matrix3d K(const CameraCalibration& c) {
  Eigen::Matrix3d k;
  k << c.fu_px, 0, c.cu_px, 0, c.fv_px, c.cv_px, 0, 0, 1;
  return k;
}

// One row, with a fifth term that is zero after four (but for the fisheye's).
Eigen::MatrixXd D(const CameraCalibration& c) {
  const auto& k = c.distortion_coefficients;
  const bool pad = c.distortion == Distortion::kRadialTangential;
  Eigen::MatrixXd row =
      Eigen::MatrixXd::Zero(1, static_cast<Eigen::Index>(k.size()) + (pad ? 1 : 0));
  for (std::size_t i = 0; i < k.size(); ++i) row(0, static_cast<Eigen::Index>(i)) = k[i];
  return row;
}

}  // namespace

std::string OpenCvStereoText(const std::array<CameraCalibration, 2>& cameras, const Pose& T_C0C1,
                             const Rectification& r) {
  const Pose T_C1C0 = T_C0C1.Inverse();
  std::string text = "%YAML:1.0\n---\n";
  text +=
      fmt::format("image_width: {}\nimage_height: {}\n", cameras[0].width_px, cameras[0].height_px);
  for (int eye = 0; eye < 2; ++eye) {
    text += OpenCvMatrix(fmt::format("K{}", eye + 1), K(cameras[eye]));
    text += OpenCvMatrix(fmt::format("D{}", eye + 1), D(cameras[eye]));
    text += fmt::format("fisheye{}: {}\n", eye + 1,
                        cameras[eye].distortion == Distortion::kEquidistant ? 1 : 0);
  }
  text += OpenCvMatrix("R", T_C1C0.R) + OpenCvMatrix("T", T_C1C0.p);
  for (int eye = 0; eye < 2; ++eye) {
    text += OpenCvMatrix(fmt::format("R{}", eye + 1), r.R[eye]);
    text += OpenCvMatrix(fmt::format("P{}", eye + 1), r.P[eye]);
  }
  return text + OpenCvMatrix("Q", r.Q());
}

std::string RosCameraInfoText(const std::string& name, int eye, const CameraCalibration& camera,
                              const Rectification& r) {
  const char* model = nullptr;
  const std::size_t terms = camera.distortion_coefficients.size();
  if (camera.distortion == Distortion::kEquidistant) model = "equidistant";
  if (camera.distortion != Distortion::kEquidistant && terms <= 5) model = "plumb_bob";
  if (camera.distortion == Distortion::kOpenCv && terms == 8) model = "rational_polynomial";
  if (!model) return {};
  return fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n", camera.width_px,
                     camera.height_px, name) +
         RosMatrix("camera_matrix", K(camera)) + fmt::format("distortion_model: {}\n", model) +
         RosMatrix("distortion_coefficients", D(camera)) +
         RosMatrix("rectification_matrix", r.R[eye]) + RosMatrix("projection_matrix", r.P[eye]);
}

}  // namespace flextip
