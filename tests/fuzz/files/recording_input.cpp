#include <algorithm>
#include <string>

#include "recording/recording_file.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/truth.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {
namespace {

constexpr std::string_view kRecording =
    "format: flextip-recording\nversion: 1\n"
    "instrument: {length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}\n"
    "port: {position_m: [0.28, 0.0, 0.0]}\ngravity_m_s2: [0.0, 0.0, -9.81]\n";
constexpr std::string_view kStreams[] = {"wrist0",  "command0", "em0",   "em1",
                                         "strain0", "load0",    "cam0",  "cam1",
                                         "tags0",   "vision0",  "truth0"};
// Streams of an arm, which are read where an arm.yaml says what its joints are.
constexpr std::string_view kArmStreams[] = {"joints0", "joints_command0", "joints_seen0", "torque0",
                                            "pose0"};
constexpr std::string_view kArm =
    "format: flextip-arm\nversion: 1\nconvention: dh\njoints:\n"
    "  - {type: revolute, a_m: 0, alpha_rad: 1.5, d_m: 0.2, theta_rad: 0}\n"
    "  - {type: prismatic, a_m: 0.1, alpha_rad: 0, d_m: 0, theta_rad: 0}\n";

bool IsOneOf(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// An arm of two joints with its measured joints, into which a stream of the input goes.
void WriteArmParts(const InputFolder& folder) {
  folder.Write("rec/arm.yaml", kArm);
  folder.Write("rec/joints0/sensor.yaml", "rate_hz: 10\njoint_noise: [1e-4, 1e-5]\n");
  folder.Write("rec/joints0/data.csv", "#timestamp [ns],q1 [rad],q2 [m]\n1,0.1,0.2\n2,0.3,0.4\n");
}

void RequireInBounds(const Recording& r) {
  Require(r.instrument.length_m >= 1e-4 && r.instrument.length_m <= 1e4);
  Require(r.p_RP.allFinite() && r.p_RP.cwiseAbs().maxCoeff() <= 1e5);
  Require(r.gravity_m_s2.allFinite() && r.gravity_m_s2.cwiseAbs().maxCoeff() <= 1e5);
  if (r.wrist0) {
    for (const auto& sample : r.wrist0->samples)
      Require(sample.value.p_RW.cwiseAbs().maxCoeff() <= 1e5);
  }
  if (r.strain0) {
    for (const auto& m : r.strain0->moments_Nm) Require(m.value.cwiseAbs().maxCoeff() <= 1e6);
  }
  for (const auto& joints : {r.joints0, r.joints_command0, r.joints_seen0}) {
    if (!joints) continue;
    for (const auto& sample : joints->q)
      Require(sample.value.size() == r.arm->Size() && sample.value.cwiseAbs().maxCoeff() <= 1e5);
  }
  if (r.torque0) {
    for (const auto& sample : r.torque0->tau) Require(sample.value.cwiseAbs().maxCoeff() <= 1e6);
  }
}

}  // namespace

int CheckRecordingInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto parts = PartsOf(input);
  if (parts.size() < 3) {
    const auto file = folder.Write("alone/recording.yaml", parts[0]);
    ReadLog log;
    const bool read = ReadsOrRefuses([&] { ReadRecordingFile(file, log); });
    return read ? 1 : 0;
  }
  static std::string present;  // of the input before
  const std::string stream(parts[0].substr(0, parts[0].find('\n')));
  const bool of_arm = IsOneOf(kArmStreams, stream);
  if (!of_arm && !IsOneOf(kStreams, stream)) return 0;
  if (stream != present) std::filesystem::remove_all(folder / "rec");
  if (of_arm && stream != present) WriteArmParts(folder);
  present = stream;
  folder.Write("rec/" + stream + "/sensor.yaml", parts[1]);
  folder.Write("rec/" + stream + "/data.csv", parts[2]);
  folder.Write("rec/recording.yaml", kRecording);
  Recording recording;
  const bool read = ReadsOrRefuses(
      [&] { recording = ReadRecording(folder / "rec", {.check_frames = false}).recording; });
  if (!read) return 0;
  RequireInBounds(recording);
  ReadsOrRefuses([&] { ReadTruth(folder / "rec"); });
  std::filesystem::remove_all(folder / "again");
  WriteRecording(folder / "again", recording);
  const Recording again = ReadRecording(folder / "again", {.check_frames = false}).recording;
  RequireInBounds(again);
  return 1;
}

}  // namespace flextip
