// Recordings: read, changed, written.
#include "recording/recording.h"

#include <filesystem>

#include "core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/errors.h"
#include "python/bindings/long_call.h"
#include "python/bindings/truth.h"
#include "recording/calibrations/calibrated_recording.h"
#include "recording/recording_writer.h"

namespace flextip::python {
namespace {

Recording ReadAndWarn(const std::filesystem::path& folder,
                      const std::optional<std::filesystem::path>& tracked,
                      const Paths& calibrations, bool check_frames) {
  CalibratedRecording read = WithoutGil([&] {
    return ReadCalibrated(folder, {.calibrations = calibrations,
                                   .tracked = tracked.value_or(std::filesystem::path()),
                                   .check_frames = check_frames});
  });
  Warn(read.warnings);
  return std::move(read.recording);
}

/// Makes the folder, which must be new or empty: a recording is never mixed with another.
void MakeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder)) {
    throw InputError::At(folder.string(), 0, "no folder can be made there");
  }
  if (!std::filesystem::is_empty(folder)) {
    throw InputError::At(folder.string(), 0, "found files, expected a new or empty folder");
  }
}

void Write(const std::filesystem::path& folder, Recording recording, std::optional<Truth> truth) {
  WithoutGil([&] {
    MakeFolder(folder);
    WriteRecording(folder, recording);
    if (truth) WriteTruth(folder, truth->samples);
  });
}

Recording MakeRecording(const Instrument& instrument, const Eigen::Vector3d& p_RP,
                        const Eigen::Vector3d& gravity_m_s2) {
  RequireFinite("p_RP", p_RP);
  RequireFinite("gravity_m_s2", gravity_m_s2);
  Recording recording;
  recording.instrument = instrument;
  recording.p_RP = p_RP;
  recording.gravity_m_s2 = gravity_m_s2;
  return recording;
}

std::optional<Truth> ReadTruthOf(const std::filesystem::path& folder) {
  auto samples = WithoutGil([&] { return ReadTruth(folder); });
  if (!samples) return {};
  return Truth{std::move(*samples)};
}

/// A stream or value of a recording: a copy when read, so that nothing hangs on the recording.
template <class T>
void AddPart(py::class_<Recording>& recording, const char* name, T Recording::*part,
             const char* doc) {
  recording.def_property(
      name, [part](const Recording& r) { return T(r.*part); },
      [part](Recording& r, const T& value) { r.*part = value; }, doc);
}

/// Returns "<Recording of wrist0, em0>".
std::string Describe(const Recording& recording) {
  std::string names;
  const auto add = [&](bool there, const char* name) {
    if (there) names += (names.empty() ? " of " : ", ") + std::string(name);
  };
  add(recording.wrist0.has_value(), "wrist0");
  add(recording.command0.has_value(), "command0");
  add(recording.em0.has_value(), "em0");
  add(recording.em1.has_value(), "em1");
  add(recording.strain0.has_value(), "strain0");
  add(recording.load0.has_value(), "load0");
  add(recording.cam0.has_value(), "cam0");
  add(recording.cam1.has_value(), "cam1");
  add(recording.tags0.has_value(), "tags0");
  add(recording.vision0.has_value(), "vision0");
  return "<Recording" + names + ">";
}

void AddRecordingClass(py::module_& module) {
  py::class_<Recording> recording(
      module, "Recording",
      "Instrument, port and the streams there are. A stream is an object that does not change: put "
      "another one in its place, or None. Reading a stream copies it.");
  recording.def(py::init(&MakeRecording), py::arg("instrument"), py::arg("p_RP"),
                py::arg("gravity_m_s2") = Eigen::Vector3d(0.0, 0.0, -9.81),
                "A recording without streams: also the set-up of a Tracker or a Controller.");
  AddPart(recording, "instrument", &Recording::instrument, "The shaft.");
  AddPart(recording, "p_RP", &Recording::p_RP, "The port in R as registered, (3,), m.");
  AddPart(recording, "gravity_m_s2", &Recording::gravity_m_s2, "Gravity in R, (3,), m/s2.");
  AddPart(recording, "tolerances", &Recording::tolerances,
          "Tolerances \"effect.parameter\" that replace the catalogue's, lists of numbers.");
  AddPart(recording, "wrist0", &Recording::wrist0, "The wrist, or None.");
  AddPart(recording, "command0", &Recording::command0, "The wrist's commands, or None.");
  AddPart(recording, "em0", &Recording::em0, "The EM sensor on the shaft, or None.");
  AddPart(recording, "em1", &Recording::em1,
          "The EM sensor on the port, or None; only its orientation counts.");
  AddPart(recording, "strain0", &Recording::strain0, "The strain gages, or None.");
  AddPart(recording, "load0", &Recording::load0, "The force on the tip, or None.");
  AddPart(recording, "cam0", &Recording::cam0, "The camera, or None.");
  AddPart(recording, "cam1", &Recording::cam1, "A stereo laparoscope's other eye, or None.");
  AddPart(recording, "tags0", &Recording::tags0, "The tags on the instrument, or None.");
  AddPart(recording, "vision0", &Recording::vision0, "The tip as seen, or None.");
  recording.def("__repr__", &Describe);
  recording.def(
      "copy", [](const Recording& r) { return Recording(r); }, "Returns a copy.");
}

void AddTruth(py::module_& module) {
  py::class_<Truth>(module, "Truth", "A simulation's truth, in R. For scoring only.")
      .def_property_readonly(
          "t_ns", [](const Truth& t) { return Times(t.samples); }, "Times, (N,) int64, ns.")
      .def_property_readonly(
          "p_RE",
          [](const Truth& t) {
            return Table(t.samples, {3},
                         [](const auto& s, double* row) { Put(s.value.p_RE, row); });
          },
          "Tip, (N, 3), m.")
      .def_property_readonly(
          "q_RE",
          [](const Truth& t) {
            return Table(t.samples, {4},
                         [](const auto& s, double* row) { PutQuaternion(s.value.q_RE, row); });
          },
          "Orientation of the tip frame, w, x, y, z, (N, 4).")
      .def_property_readonly(
          "p_RW",
          [](const Truth& t) {
            return Table(t.samples, {3},
                         [](const auto& s, double* row) { Put(s.value.p_RW, row); });
          },
          "Wrist, (N, 3), m.");
  module.def("read_truth", &ReadTruthOf, py::arg("folder"),
             "Reads truth0 of a recording's folder; None where there is none. Raises InputError.");
}

}  // namespace

void AddRecording(py::module_& module) {
  AddRecordingClass(module);
  AddTruth(module);
  module.def("read_recording", &ReadAndWarn, py::arg("folder"), py::kw_only(),
             py::arg("tracked") = std::nullopt, py::arg("calibrations") = Paths(),
             py::arg("check_frames") = false,
             R"doc(Reads a recording's folder.

tracked: a result of flextip track; its tips replace vision0.
calibrations: calibration.yaml files; their values replace the recording's, in this order.
check_frames: also that the cameras' pictures are there and have the stated size.

Data that was skipped is a RecordingWarning. Raises InputError with file and line for data that
cannot be trusted.)doc");
  module.def("write_recording", &Write, py::arg("folder"), py::arg("recording"),
             py::arg("truth") = std::nullopt,
             "Writes all streams below a new or empty folder, so that reading them gives the same "
             "numbers. Pictures are not written. Raises InputError for a folder that holds "
             "something, WorkError where the disk refuses.");
}

}  // namespace flextip::python
