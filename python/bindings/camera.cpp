// Cameras and tag collars as data, and their files.
#include "core/camera.h"

#include <array>

#include "core/error.h"
#include "core/tag_collar.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/errors.h"
#include "recording/cameras/camera_formats.h"
#include "recording/cameras/yaml.h"
#include "recording/streams/sensor_streams.h"
#include "vision/camera_model.h"

namespace flextip::python {
namespace {

CameraCalibration MakeCamera(const Eigen::Vector4d& intrinsics,
                             const std::array<int, 2>& resolution, const Eigen::Matrix4d& T_RC,
                             const std::string& model, const std::vector<double>& coefficients,
                             std::optional<double> gamma, double rate_hz) {
  CameraCalibration camera;
  RequireFinite("intrinsics", intrinsics);
  camera.width_px = resolution[0];
  camera.height_px = resolution[1];
  camera.fu_px = intrinsics[0];
  camera.fv_px = intrinsics[1];
  camera.cu_px = intrinsics[2];
  camera.cv_px = intrinsics[3];
  const NamedDistortion named = DistortionOf(model, coefficients.size());
  if (!named.distortion) throw InputError(named.wrong_key + ": " + named.expected);
  camera.distortion = *named.distortion;
  camera.distortion_coefficients = coefficients;
  if (gamma) camera.gamma = Positive("gamma", *gamma);
  camera.T_RC = PoseFrom("T_RC", T_RC);
  camera.rate_hz = Positive("rate_hz", rate_hz);
  (void)CameraModel(camera);  // throws for values that no camera has
  return camera;
}

CameraCalibration ReadCameraFile(const std::filesystem::path& file) {
  return ReadCameraDescription(file, GuessCameraFormat(file)).calibration;
}

TagCollar ReadCollar(const std::filesystem::path& file) {
  ReadLog log;
  TagCollar collar = ReadCollarFile(file, log);
  Warn(log.warnings);
  return collar;
}

void AddCollar(py::module_& module) {
  py::class_<CollarTag>(module, "CollarTag", "A tag of a collar.")
      .def(py::init([](int id, double size_m, const Eigen::Matrix4d& T_EG) {
             return CollarTag{id, Positive("size_m", size_m), PoseFrom("T_EG", T_EG)};
           }),
           py::arg("id"), py::arg("size_m"), py::arg("T_EG"),
           "Raises InputError for a size not above zero and a T_EG that is no rigid transform.")
      .def_readonly("id", &CollarTag::id, "Number in its family.")
      .def_readonly("size_m", &CollarTag::size_m,
                    "Side between the detected corners (m); tag36h11: the black border's outer "
                    "edge.")
      .def_property_readonly(
          "T_EG", [](const CollarTag& tag) { return tag.T_EG.Matrix(); },
          "Pose of the tag G in the tip frame E, (4, 4), m. G: origin at the centre, x right and y "
          "down as it is read, z into it.");
  py::class_<TagCollar>(module, "TagCollar", "The AprilTags on an instrument.")
      .def(py::init([](const std::vector<CollarTag>& tags, const std::string& family) {
             return TagCollar{family, tags};
           }),
           py::arg("tags"), py::arg("family") = "tag36h11")
      .def_readonly("family", &TagCollar::family, "Tag family, such as \"tag36h11\".")
      .def_readonly("tags", &TagCollar::tags, "The tags.");
}

}  // namespace

void AddCamera(py::module_& module) {
  py::class_<CameraCalibration>(
      module, "Camera",
      "A pinhole camera with lens distortion. Pixel (0, 0) is the centre of the top-left pixel.")
      .def(py::init(&MakeCamera), py::arg("intrinsics"), py::arg("resolution"), py::arg("T_RC"),
           py::kw_only(), py::arg("distortion_model") = "radial-tangential",
           py::arg("distortion_coefficients") = std::vector<double>{0, 0, 0, 0},
           py::arg("gamma") = std::nullopt, py::arg("rate_hz") = 30.0,
           "Raises InputError for an unknown model and a T_RC that is no rigid transform.")
      .def_property_readonly(
          "intrinsics",
          [](const CameraCalibration& c) {
            return Eigen::Vector4d(c.fu_px, c.fv_px, c.cu_px, c.cv_px);
          },
          "fu, fv, cu, cv (px), (4,).")
      .def_property_readonly(
          "resolution",
          [](const CameraCalibration& c) { return std::make_pair(c.width_px, c.height_px); },
          "Width and height (px).")
      .def_property_readonly(
          "T_RC", [](const CameraCalibration& c) { return c.T_RC.Matrix(); },
          "Pose of the camera C in R, (4, 4), m. C: x right, y down, z forward.")
      .def_property_readonly(
          "distortion_model",
          [](const CameraCalibration& c) { return DistortionName(c.distortion); },
          "\"radial-tangential\", \"opencv\" or \"equidistant\".")
      .def_readonly("distortion_coefficients", &CameraCalibration::distortion_coefficients,
                    "k1 k2 p1 p2 (radial-tangential), OpenCV's 5, 8 or 12 terms, or k1 to k4 "
                    "(equidistant).")
      .def_readonly("gamma", &CameraCalibration::gamma,
                    "Exponent with which the camera encodes linear light; None: not known.")
      .def_readonly("rate_hz", &CameraCalibration::rate_hz, "Pictures a second.");
  AddCollar(module);
  module.def("read_camera", &ReadCameraFile, py::arg("file"),
             "Reads a camera file of EuRoC, Kalibr, ROS or OpenCV. Raises InputError.");
  module.def("read_collar", &ReadCollar, py::arg("file"),
             "Reads a collar's file, as a recording's tags0/sensor.yaml. Raises InputError.");
}

}  // namespace flextip::python
