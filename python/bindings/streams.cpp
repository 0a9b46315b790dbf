// The streams of wrist, EM sensors, gages and load as numpy arrays.
#include <array>

#include "core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "recording/recording.h"

namespace flextip::python {
namespace {

constexpr const char* kTimes = "Times, (N,) int64, ns, increasing.";
constexpr const char* kRate = "Samples a second, as stated.";
constexpr const char* kComment = "A remark, kept in the file.";
constexpr const char* kPositionNoise = "Standard deviation per axis (m).";
constexpr const char* kTurnNoise = "Standard deviation per axis (rad).";

void AddWrist(py::module_& module) {
  const auto make = [](const py::array& t_ns, const Doubles& p_RW,
                       const std::optional<Doubles>& q_RW, double rate_hz, double position_noise_m,
                       double orientation_noise_rad, const std::string& comment) {
    const std::vector<TimeNs> times = TimesFrom("t_ns", t_ns);
    const Rows p("p_RW", p_RW, times.size(), 3);
    std::optional<Rows> q;
    if (q_RW) q.emplace("q_RW", *q_RW, times.size(), 4);
    WristStream stream{comment,
                       Positive("rate_hz", rate_hz),
                       NotNegative("position_noise_m", position_noise_m),
                       NotNegative("orientation_noise_rad", orientation_noise_rad),
                       {}};
    for (std::size_t i = 0; i < times.size(); ++i) {
      stream.samples.push_back({times[i], {p.Vector3(i), q ? q->Quaternion(i) : std::nullopt}});
    }
    return stream;
  };
  py::class_<WristStream>(module, "WristStream",
                          "wrist0: the wrist W in R by the robot's encoders.")
      .def(py::init(make), py::arg("t_ns"), py::arg("p_RW"), py::arg("q_RW") = std::nullopt,
           py::kw_only(), py::arg("rate_hz"), py::arg("position_noise_m"),
           py::arg("orientation_noise_rad") = 0.0, py::arg("comment") = "",
           "Rows of zeros in q_RW: not measured. Raises InputError for other shapes, NaN, times "
           "that do not increase and quaternions off unit length.")
      .def_property_readonly(
          "t_ns", [](const WristStream& s) { return Times(s.samples); }, kTimes)
      .def_property_readonly(
          "p_RW",
          [](const WristStream& s) {
            return Table(s.samples, {3},
                         [](const auto& w, double* row) { Put(w.value.p_RW, row); });
          },
          "Position, (N, 3), m.")
      .def_property_readonly(
          "q_RW",
          [](const WristStream& s) {
            return Table(s.samples, {4}, [](const auto& w, double* row) {
              if (w.value.q_RW) PutQuaternion(*w.value.q_RW, row);
            });
          },
          "Orientation w, x, y, z, (N, 4); zeros where it was not measured.")
      .def_readonly("rate_hz", &WristStream::rate_hz, kRate)
      .def_readonly("position_noise_m", &WristStream::position_noise_m, kPositionNoise)
      .def_readonly("orientation_noise_rad", &WristStream::orientation_noise_rad, kTurnNoise)
      .def_readonly("comment", &WristStream::comment, kComment);
}

void AddCommand(py::module_& module) {
  const auto make = [](const py::array& t_ns, const Doubles& p_RW, double rate_hz,
                       const std::string& comment) {
    const std::vector<TimeNs> times = TimesFrom("t_ns", t_ns);
    const Rows p("p_RW", p_RW, times.size(), 3);
    CommandStream stream{comment, Positive("rate_hz", rate_hz), {}};
    for (std::size_t i = 0; i < times.size(); ++i) stream.p_RW.push_back({times[i], p.Vector3(i)});
    return stream;
  };
  py::class_<CommandStream>(module, "CommandStream",
                            "command0: where the wrist was told to go, in R.")
      .def(py::init(make), py::arg("t_ns"), py::arg("p_RW"), py::kw_only(), py::arg("rate_hz"),
           py::arg("comment") = "", "Raises InputError as WristStream.")
      .def_property_readonly(
          "t_ns", [](const CommandStream& s) { return Times(s.p_RW); }, kTimes)
      .def_property_readonly(
          "p_RW",
          [](const CommandStream& s) {
            return Table(s.p_RW, {3}, [](const auto& p, double* row) { Put(p.value, row); });
          },
          "Position, (N, 3), m.")
      .def_readonly("rate_hz", &CommandStream::rate_hz, kRate)
      .def_readonly("comment", &CommandStream::comment, kComment);
}

NoiseDistribution DistributionNamed(const std::string& name) {
  if (name == "gaussian") return NoiseDistribution::kGaussian;
  if (name == "uniform") return NoiseDistribution::kUniform;
  throw InputError("noise_distribution: found " + name + ", expected gaussian or uniform");
}

void AddEm(py::module_& module) {
  const auto make = [](const py::array& t_ns, const Doubles& p_RS, const Doubles& q_RS,
                       double rate_hz, double distance_from_tip_m, double position_noise_m,
                       double orientation_noise_rad, const std::string& noise_distribution,
                       double registration_noise_rad, double registration_noise_m,
                       const std::string& comment) {
    const std::vector<TimeNs> times = TimesFrom("t_ns", t_ns);
    const Rows p("p_RS", p_RS, times.size(), 3), q("q_RS", q_RS, times.size(), 4);
    EmStream stream;
    stream.comment = comment;
    stream.rate_hz = Positive("rate_hz", rate_hz);
    stream.distance_from_tip_m = NotNegative("distance_from_tip_m", distance_from_tip_m);
    stream.position_noise_m = NotNegative("position_noise_m", position_noise_m);
    stream.orientation_noise_rad = NotNegative("orientation_noise_rad", orientation_noise_rad);
    stream.noise_distribution = DistributionNamed(noise_distribution);
    stream.registration_noise_rad = NotNegative("registration_noise_rad", registration_noise_rad);
    stream.registration_noise_m = NotNegative("registration_noise_m", registration_noise_m);
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto turn = q.Quaternion(i);
      if (!turn) throw InputError("q_RS: found a quaternion of zeros, expected unit length");
      stream.samples.push_back({times[i], {p.Vector3(i), *turn}});
    }
    return stream;
  };
  py::class_<EmStream>(module, "EmStream",
                       "em0, em1: an electromagnetic sensor S in R, on the shaft or on the port.")
      .def(py::init(make), py::arg("t_ns"), py::arg("p_RS"), py::arg("q_RS"), py::kw_only(),
           py::arg("rate_hz"), py::arg("distance_from_tip_m"), py::arg("position_noise_m"),
           py::arg("orientation_noise_rad"), py::arg("noise_distribution") = "gaussian",
           py::arg("registration_noise_rad") = 0.0, py::arg("registration_noise_m") = 0.0,
           py::arg("comment") = "", "Raises InputError as WristStream.")
      .def_property_readonly(
          "t_ns", [](const EmStream& s) { return Times(s.samples); }, kTimes)
      .def_property_readonly(
          "p_RS",
          [](const EmStream& s) {
            return Table(s.samples, {3},
                         [](const auto& e, double* row) { Put(e.value.p_RS, row); });
          },
          "Position, (N, 3), m.")
      .def_property_readonly(
          "q_RS",
          [](const EmStream& s) {
            return Table(s.samples, {4},
                         [](const auto& e, double* row) { PutQuaternion(e.value.q_RS, row); });
          },
          "Orientation w, x, y, z, (N, 4); x along the shaft.")
      .def_readonly("rate_hz", &EmStream::rate_hz, kRate)
      .def_readonly("distance_from_tip_m", &EmStream::distance_from_tip_m,
                    "From the tip along the shaft (m).")
      .def_readonly("position_noise_m", &EmStream::position_noise_m, kPositionNoise)
      .def_readonly("orientation_noise_rad", &EmStream::orientation_noise_rad, kTurnNoise)
      .def_property_readonly(
          "noise_distribution",
          [](const EmStream& s) {
            return s.noise_distribution == NoiseDistribution::kUniform ? "uniform" : "gaussian";
          },
          "\"gaussian\" or \"uniform\".")
      .def_readonly("registration_noise_rad", &EmStream::registration_noise_rad,
                    "How well the sensor's frame is known in R: turn (rad).")
      .def_readonly("registration_noise_m", &EmStream::registration_noise_m,
                    "How well the sensor's frame is known in R: shift (m).")
      .def_readonly("comment", &EmStream::comment, kComment);
}

void AddStrain(py::module_& module) {
  const auto make = [](const py::array& t_ns, const Doubles& moments_Nm,
                       const std::array<double, 2>& stations_from_wrist_m, double rate_hz,
                       double moment_noise_Nm, const std::string& comment) {
    const std::vector<TimeNs> times = TimesFrom("t_ns", t_ns);
    const Rows m("moments_Nm", moments_Nm, times.size(), 4);
    StrainStream stream;
    stream.comment = comment;
    stream.rate_hz = Positive("rate_hz", rate_hz);
    stream.station_from_wrist_m[0] = Positive("stations_from_wrist_m", stations_from_wrist_m[0]);
    stream.station_from_wrist_m[1] = Positive("stations_from_wrist_m", stations_from_wrist_m[1]);
    stream.moment_noise_Nm = NotNegative("moment_noise_Nm", moment_noise_Nm);
    for (std::size_t i = 0; i < times.size(); ++i) {
      stream.moments_Nm.push_back({times[i], Eigen::Map<const Eigen::Vector4d>(m[i])});
    }
    return stream;
  };
  py::class_<StrainStream>(
      module, "StrainStream",
      "strain0: internal bending moments at two stations, of the part beyond on the part before, "
      "about the wrist's y and z axes carried along the shaft without twist.")
      .def(py::init(make), py::arg("t_ns"), py::arg("moments_Nm"), py::arg("stations_from_wrist_m"),
           py::kw_only(), py::arg("rate_hz"), py::arg("moment_noise_Nm"), py::arg("comment") = "",
           "Raises InputError as WristStream.")
      .def_property_readonly(
          "t_ns", [](const StrainStream& s) { return Times(s.moments_Nm); }, kTimes)
      .def_property_readonly(
          "moments_Nm",
          [](const StrainStream& s) {
            return Table(s.moments_Nm, {4}, [](const auto& m, double* row) { Put(m.value, row); });
          },
          "m1_y, m1_z, m2_y, m2_z, (N, 4), Nm.")
      .def_property_readonly(
          "stations_from_wrist_m",
          [](const StrainStream& s) {
            return std::make_pair(s.station_from_wrist_m[0], s.station_from_wrist_m[1]);
          },
          "Both stations, along the shaft (m).")
      .def_readonly("rate_hz", &StrainStream::rate_hz, kRate)
      .def_readonly("moment_noise_Nm", &StrainStream::moment_noise_Nm,
                    "Standard deviation of a moment (Nm).")
      .def_readonly("comment", &StrainStream::comment, kComment);
}

void AddLoad(py::module_& module) {
  const auto make = [](const py::array& t_ns, const Doubles& f_tip_N, double rate_hz,
                       double force_noise_N, const std::string& comment) {
    const std::vector<TimeNs> times = TimesFrom("t_ns", t_ns);
    const Rows f("f_tip_N", f_tip_N, times.size(), 3);
    LoadStream stream{
        comment, Positive("rate_hz", rate_hz), NotNegative("force_noise_N", force_noise_N), {}};
    for (std::size_t i = 0; i < times.size(); ++i)
      stream.f_tip_N.push_back({times[i], f.Vector3(i)});
    return stream;
  };
  py::class_<LoadStream>(module, "LoadStream", "load0: the force on the tip, in R.")
      .def(py::init(make), py::arg("t_ns"), py::arg("f_tip_N"), py::kw_only(), py::arg("rate_hz"),
           py::arg("force_noise_N"), py::arg("comment") = "", "Raises InputError as WristStream.")
      .def_property_readonly(
          "t_ns", [](const LoadStream& s) { return Times(s.f_tip_N); }, kTimes)
      .def_property_readonly(
          "f_tip_N",
          [](const LoadStream& s) {
            return Table(s.f_tip_N, {3}, [](const auto& f, double* row) { Put(f.value, row); });
          },
          "Force on the tip, (N, 3), N.")
      .def_readonly("rate_hz", &LoadStream::rate_hz, kRate)
      .def_readonly("force_noise_N", &LoadStream::force_noise_N, "Standard deviation per axis (N).")
      .def_readonly("comment", &LoadStream::comment, kComment);
}

}  // namespace

void AddStreams(py::module_& module) {
  AddWrist(module);
  AddCommand(module);
  AddEm(module);
  AddStrain(module);
  AddLoad(module);
}

}  // namespace flextip::python
