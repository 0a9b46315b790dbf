// One sample of each sensor: what a tracker and a controller are told in a cycle.
#include <array>

#include "core/error.h"
#include "pipeline/sensor_readings.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"

namespace flextip::python {
namespace {

using WristReading = Sample<WristMeasurement>;
using TipReading = Sample<TipMeasurement>;
using EmReading = Sample<EmMeasurement>;
using StrainReading = Sample<StrainMeasurement>;
using LoadReading = Sample<LoadMeasurement>;

constexpr const char* kReadingTime = "Time (ns).";

WristReading MakeWrist(TimeNs t_ns, const Eigen::Vector3d& p_RW,
                       const std::optional<Eigen::Matrix3d>& R_RW, double position_noise_m,
                       double orientation_noise_rad) {
  return {t_ns,
          {p_RW, R_RW, Positive("position_noise_m", position_noise_m),
           R_RW ? Positive("orientation_noise_rad", orientation_noise_rad) : 0.0}};
}

TipReading MakeTip(TimeNs t_ns, const Eigen::Vector3d& p_RE, const Eigen::Matrix3d& covariance_m2,
                   const std::optional<Eigen::Vector3d>& d_RE, double direction_noise_rad) {
  const double noise = d_RE ? Positive("direction_noise_rad", direction_noise_rad) : 0.0;
  return {t_ns, {{TipStatus::kOk, p_RE, covariance_m2, d_RE}, noise}};
}

EmReading MakeEm(TimeNs t_ns, const Eigen::Matrix4d& T_RS, double distance_from_tip_m,
                 double position_noise_m, double orientation_noise_rad) {
  return {t_ns,
          {PoseFrom("T_RS", T_RS), NotNegative("distance_from_tip_m", distance_from_tip_m),
           Positive("position_noise_m", position_noise_m),
           Positive("orientation_noise_rad", orientation_noise_rad)}};
}

StrainReading MakeStrain(TimeNs t_ns, const Eigen::Vector4d& moments_Nm,
                         const std::array<double, 2>& stations_from_wrist_m,
                         double moment_noise_Nm) {
  StrainReading reading{t_ns, {}};
  reading.value.moments_Nm = moments_Nm;
  reading.value.station_from_wrist_m[0] =
      Positive("stations_from_wrist_m", stations_from_wrist_m[0]);
  reading.value.station_from_wrist_m[1] =
      Positive("stations_from_wrist_m", stations_from_wrist_m[1]);
  reading.value.moment_noise_Nm = Positive("moment_noise_Nm", moment_noise_Nm);
  return reading;
}

LoadReading MakeLoad(TimeNs t_ns, const Eigen::Vector3d& f_tip_N, double force_noise_N) {
  return {t_ns, {f_tip_N, Positive("force_noise_N", force_noise_N)}};
}

void AddPoseReadings(py::module_& module) {
  py::class_<WristReading>(module, "WristReading", "The wrist W in R by the robot's encoders.")
      .def(py::init(&MakeWrist), py::arg("t_ns"), py::arg("p_RW"), py::arg("R_RW") = std::nullopt,
           py::kw_only(), py::arg("position_noise_m"), py::arg("orientation_noise_rad") = 0.0,
           "Noises: standard deviations per axis; the orientation's only with R_RW.")
      .def_readonly("t_ns", &WristReading::t_ns, kReadingTime)
      .def_property_readonly(
          "p_RW", [](const WristReading& r) { return Eigen::Vector3d(r.value.p_RW); },
          "Position, (3,), m.")
      .def_property_readonly(
          "R_RW", [](const WristReading& r) { return std::optional(r.value.R_RW); },
          "Orientation, (3, 3), or None where it is not measured.")
      .def_property_readonly(
          "position_noise_m", [](const WristReading& r) { return r.value.position_noise_m; },
          "Standard deviation per axis (m).")
      .def_property_readonly(
          "orientation_noise_rad",
          [](const WristReading& r) { return r.value.orientation_noise_rad; },
          "Standard deviation per axis (rad).");
  py::class_<TipReading>(module, "TipReading", "The tip E in R by vision.")
      .def(py::init(&MakeTip), py::arg("t_ns"), py::arg("p_RE"), py::arg("covariance_m2"),
           py::arg("d_RE") = std::nullopt, py::kw_only(), py::arg("direction_noise_rad") = 0.0,
           "A measured tip; one that was not seen is left out of the Readings.")
      .def_readonly("t_ns", &TipReading::t_ns, kReadingTime)
      .def_property_readonly(
          "status", [](const TipReading& r) { return Name(r.value.tip.status); },
          "\"ok\", \"predicted\" or \"lost\".")
      .def_property_readonly(
          "p_RE", [](const TipReading& r) { return Eigen::Vector3d(r.value.tip.p_RE); },
          "Position, (3,), m; zeros where it is lost.")
      .def_property_readonly(
          "covariance_m2",
          [](const TipReading& r) { return Eigen::Matrix3d(r.value.tip.covariance_m2); },
          "Covariance of p_RE in R, (3, 3), m2.")
      .def_property_readonly(
          "d_RE", [](const TipReading& r) { return std::optional(r.value.tip.d_RE); },
          "The shaft's direction, unit, (3,), or None where it was not seen.")
      .def_property_readonly(
          "direction_noise_rad", [](const TipReading& r) { return r.value.direction_noise_rad; },
          "Standard deviation of d_RE per axis across it (rad).");
  py::class_<EmReading>(module, "EmReading", "An electromagnetic sensor S in R.")
      .def(py::init(&MakeEm), py::arg("t_ns"), py::arg("T_RS"), py::arg("distance_from_tip_m"),
           py::kw_only(), py::arg("position_noise_m"), py::arg("orientation_noise_rad"),
           "Noises: standard deviations per axis.")
      .def_readonly("t_ns", &EmReading::t_ns, kReadingTime)
      .def_property_readonly(
          "T_RS", [](const EmReading& r) { return r.value.T_RS.Matrix(); },
          "Pose, (4, 4), m; x along the shaft.")
      .def_property_readonly(
          "distance_from_tip_m", [](const EmReading& r) { return r.value.distance_from_tip_m; },
          "From the tip along the shaft (m).")
      .def_property_readonly(
          "position_noise_m", [](const EmReading& r) { return r.value.position_noise_m; },
          "Standard deviation per axis (m).")
      .def_property_readonly(
          "orientation_noise_rad", [](const EmReading& r) { return r.value.orientation_noise_rad; },
          "Standard deviation per axis (rad).");
}

void AddForceReadings(py::module_& module) {
  py::class_<StrainReading>(module, "StrainReading", "Bending moments as in StrainStream.")
      .def(py::init(&MakeStrain), py::arg("t_ns"), py::arg("moments_Nm"),
           py::arg("stations_from_wrist_m"), py::kw_only(), py::arg("moment_noise_Nm"),
           "moment_noise_Nm: standard deviation of a moment.")
      .def_readonly("t_ns", &StrainReading::t_ns, kReadingTime)
      .def_property_readonly(
          "moments_Nm", [](const StrainReading& r) { return Eigen::Vector4d(r.value.moments_Nm); },
          "m1_y, m1_z, m2_y, m2_z, (4,), Nm.")
      .def_property_readonly(
          "stations_from_wrist_m",
          [](const StrainReading& r) {
            return std::make_pair(r.value.station_from_wrist_m[0], r.value.station_from_wrist_m[1]);
          },
          "Both stations, along the shaft (m).")
      .def_property_readonly(
          "moment_noise_Nm", [](const StrainReading& r) { return r.value.moment_noise_Nm; },
          "Standard deviation of a moment (Nm).");
  py::class_<LoadReading>(module, "LoadReading", "The force on the tip, in R.")
      .def(py::init(&MakeLoad), py::arg("t_ns"), py::arg("f_tip_N"), py::kw_only(),
           py::arg("force_noise_N"), "force_noise_N: standard deviation per axis.")
      .def_readonly("t_ns", &LoadReading::t_ns, kReadingTime)
      .def_property_readonly(
          "f_tip_N", [](const LoadReading& r) { return Eigen::Vector3d(r.value.f_tip_N); },
          "Force on the tip, (3,), N.")
      .def_property_readonly(
          "force_noise_N", [](const LoadReading& r) { return r.value.force_noise_N; },
          "Standard deviation per axis (N).");
}

/// A sensor's reading: a copy when read.
template <class T>
void AddSensor(py::class_<SensorReadings>& readings, const char* name,
               std::optional<T> SensorReadings::*sensor, const char* doc) {
  readings.def_property(
      name, [sensor](const SensorReadings& r) { return std::optional<T>(r.*sensor); },
      [sensor](SensorReadings& r, const std::optional<T>& value) { r.*sensor = value; }, doc);
}

}  // namespace

void AddReadings(py::module_& module) {
  AddPoseReadings(module);
  AddForceReadings(module);
  py::class_<SensorReadings> readings(module, "Readings",
                                      "The newest sample of each sensor. None: no sample.");
  readings.def(
      py::init([](const std::optional<WristReading>& wrist, const std::optional<TipReading>& tip,
                  const std::optional<EmReading>& em0, const std::optional<EmReading>& em1,
                  const std::optional<StrainReading>& strain,
                  const std::optional<LoadReading>& load) {
        return SensorReadings{wrist, tip, em0, em1, strain, load};
      }),
      py::arg("wrist") = std::nullopt, py::arg("tip") = std::nullopt, py::arg("em0") = std::nullopt,
      py::arg("em1") = std::nullopt, py::arg("strain") = std::nullopt,
      py::arg("load") = std::nullopt, "em0: on the shaft; em1: on the port.");
  AddSensor(readings, "wrist", &SensorReadings::wrist, "The wrist.");
  AddSensor(readings, "tip", &SensorReadings::tip, "The tip by vision.");
  AddSensor(readings, "em0", &SensorReadings::em0, "The EM sensor on the shaft.");
  AddSensor(readings, "em1", &SensorReadings::em1, "The EM sensor on the port.");
  AddSensor(readings, "strain", &SensorReadings::strain, "The strain gages.");
  AddSensor(readings, "load", &SensorReadings::load, "The force on the tip.");
  module.def(
      "readings_at",
      [](const Recording& recording, TimeNs t_ns) { return ReadingsAt(recording, t_ns); },
      py::arg("recording"), py::arg("t_ns"),
      "Returns the sensors of a recording at a time (ns), interpolated. The tip by vision is there "
      "only at the times of its own frames.");
}

}  // namespace flextip::python
