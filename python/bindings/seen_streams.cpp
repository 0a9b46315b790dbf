// The streams of cameras and of the tips seen as numpy arrays.
#include <fmt/format.h>

#include "core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "recording/recording.h"

namespace flextip::python {
namespace {

constexpr const char* kFrameTimes = "Times, (N,) int64, ns, increasing.";

void AddCameraStream(py::module_& module) {
  const auto make = [](const CameraCalibration& camera, const std::string& comment) {
    CameraStream stream;
    stream.comment = comment;
    stream.calibration = camera;
    return stream;
  };
  py::class_<CameraStream>(module, "CameraStream",
                           "cam0, cam1: a camera and the times of its frames, which stay files.")
      .def(py::init(make), py::arg("camera"), py::kw_only(), py::arg("comment") = "",
           "A camera without frames.")
      .def_property_readonly(
          "t_ns",
          [](const CameraStream& s) {
            return s.frame_numbers.empty() ? Times(s.filenames) : Times(s.frame_numbers);
          },
          kFrameTimes)
      .def_readonly("camera", &CameraStream::calibration, "The camera.")
      .def_readonly("video", &CameraStream::video,
                    "Name of the video inside the camera's folder; empty for pictures.")
      .def_property_readonly(
          "filenames",
          [](const CameraStream& s) {
            std::vector<std::string> names;
            for (const auto& frame : s.filenames) names.push_back(frame.value);
            return names;
          },
          "Names of the pictures; empty for a video.")
      .def_property_readonly(
          "frame_numbers",
          [](const CameraStream& s) {
            return Column<TimeNs>(s.frame_numbers, [](const auto& f) { return TimeNs(f.value); });
          },
          "Numbers of the video's frames, (N,) int64; empty for pictures.")
      .def_readonly("comment", &CameraStream::comment, "A remark, kept in the file.");
}

TipStatus TipStatusNamed(const std::string& name) {
  for (const TipStatus status : {TipStatus::kOk, TipStatus::kPredicted, TipStatus::kLost}) {
    if (name == Name(status)) return status;
  }
  throw InputError("status: found " + name + ", expected ok, predicted or lost");
}

VisionStream MakeVision(const py::array& t_ns, const Doubles& p_RE, const Doubles& covariance_m2,
                        const std::vector<std::string>& status, const std::optional<Doubles>& d_RE,
                        double rate_hz, double direction_noise_rad, double registration_noise_rad,
                        double registration_noise_m, const std::string& camera,
                        const std::string& comment) {
  const std::vector<TimeNs> times = TimesFrom("t_ns", t_ns);
  const std::size_t n = times.size();
  if (status.size() != n) {
    throw InputError(fmt::format("status: found {} texts, expected {}", status.size(), n));
  }
  const Rows p("p_RE", p_RE, n, 3), covariance("covariance_m2", covariance_m2, n, 3, 3);
  std::optional<Rows> d;
  if (d_RE) d.emplace("d_RE", *d_RE, n, 3);
  VisionStream stream;
  stream.comment = comment;
  stream.rate_hz = Positive("rate_hz", rate_hz);
  stream.camera = camera;
  stream.direction_noise_rad = NotNegative("direction_noise_rad", direction_noise_rad);
  stream.registration_noise_rad = NotNegative("registration_noise_rad", registration_noise_rad);
  stream.registration_noise_m = NotNegative("registration_noise_m", registration_noise_m);
  for (std::size_t i = 0; i < n; ++i) {
    TipObservation tip;
    tip.status = TipStatusNamed(status[i]);
    if (tip.status != TipStatus::kLost) {
      tip.p_RE = p.Vector3(i);
      tip.covariance_m2 = Eigen::Map<const Eigen::Matrix3d>(covariance[i]);  // symmetric
      if (d) tip.d_RE = d->Direction(i);
    }
    stream.tips.push_back({times[i], tip});
  }
  return stream;
}

bool TipIsKnown(const Sample<TipObservation>& tip) { return tip.value.status != TipStatus::kLost; }

void AddVision(py::module_& module) {
  py::class_<VisionStream>(
      module, "VisionStream",
      "vision0: the tip as seen, in R. Rows whose status is \"lost\" are zeros.")
      .def(py::init(&MakeVision), py::arg("t_ns"), py::arg("p_RE"), py::arg("covariance_m2"),
           py::arg("status"), py::arg("d_RE") = std::nullopt, py::kw_only(), py::arg("rate_hz"),
           py::arg("direction_noise_rad") = 0.0, py::arg("registration_noise_rad") = 0.0,
           py::arg("registration_noise_m") = 0.0, py::arg("camera") = "cam0",
           py::arg("comment") = "",
           "Rows of zeros in d_RE: not seen. Raises InputError as WristStream, and for an unknown "
           "status.")
      .def_property_readonly(
          "t_ns", [](const VisionStream& s) { return Times(s.tips); }, kFrameTimes)
      .def_property_readonly(
          "status",
          [](const VisionStream& s) {
            return TextColumn(s.tips, [](const auto& tip) { return Name(tip.value.status); });
          },
          "\"ok\" (measured), \"predicted\" or \"lost\", (N,).")
      .def_property_readonly(
          "p_RE",
          [](const VisionStream& s) {
            return Table(s.tips, {3}, [](const auto& tip, double* row) {
              if (TipIsKnown(tip)) Put(tip.value.p_RE, row);
            });
          },
          "Tip, (N, 3), m.")
      .def_property_readonly(
          "covariance_m2",
          [](const VisionStream& s) {
            return Table(s.tips, {3, 3}, [](const auto& tip, double* row) {
              if (TipIsKnown(tip)) Put(tip.value.covariance_m2, row);
            });
          },
          "Covariance of p_RE in R, (N, 3, 3), m2.")
      .def_property_readonly(
          "d_RE",
          [](const VisionStream& s) {
            return Table(s.tips, {3}, [](const auto& tip, double* row) {
              if (tip.value.d_RE) Put(*tip.value.d_RE, row);
            });
          },
          "The shaft's direction at the tip, unit, (N, 3); zeros where it was not seen.")
      .def_readonly("rate_hz", &VisionStream::rate_hz, "Frames a second, as stated.")
      .def_readonly("camera", &VisionStream::camera, "The camera that saw it, \"cam0\".")
      .def_readonly("direction_noise_rad", &VisionStream::direction_noise_rad,
                    "Standard deviation of d_RE per axis across it (rad).")
      .def_readonly("registration_noise_rad", &VisionStream::registration_noise_rad,
                    "How well the camera's frame is known in R: turn (rad).")
      .def_readonly("registration_noise_m", &VisionStream::registration_noise_m,
                    "How well the camera's frame is known in R: shift (m).")
      .def_readonly("comment", &VisionStream::comment, "A remark, kept in the file.");
}

}  // namespace

void AddSeenStreams(py::module_& module) {
  AddCameraStream(module);
  AddVision(module);
}

}  // namespace flextip::python
