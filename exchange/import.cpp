#include "exchange/import.h"

#include <fmt/format.h>

#include <utility>

#include "exchange/formats/formats.h"
#include "exchange/mapping_file.h"
#include "exchange/streams/joints.h"
#include "exchange/streams/names.h"
#include "exchange/streams/sensor_settings.h"
#include "exchange/streams/stream_settings.h"
#include "recording/recording_writer.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

void NeedInstrument(const ImportPlan& plan) {
  std::vector<std::string> keys;
  const auto need = [&](bool there, const char* key) {
    if (!there) keys.emplace_back(key);
  };
  need(plan.length_m.has_value(), "instrument.length_m");
  need(plan.outer_diameter_m.has_value(), "instrument.outer_diameter_m");
  need(plan.bending_stiffness_Nm2.has_value(), "instrument.bending_stiffness_Nm2");
  need(plan.p_RP.has_value(), "port.position_m");
  if (keys.empty()) return;
  throw NotTold(fmt::format("no file says {}", fmt::join(keys, ", ")), keys);
}

/// What the files have of a shaft has no meaning without its instrument.
void KeepJoints(ImportPlan& plan, ImportLog& log) {
  log.Assume("instrument", "none, nor a port, was told: the arm's joints alone are imported");
  std::erase_if(plan.streams, [](const auto& entry) { return !IsJointStream(entry.first); });
  plan.cameras.clear();
}

/// The arm's file beside the joints.
void AddArm(ImportPlan& plan, Imported& imported) {
  plan.arm = std::filesystem::absolute(plan.arm).lexically_normal();
  imported.recording.has_shaft = !IsOfArmAlone(plan);
  const auto is_joints = [](const StreamLine& line) { return IsJointStream(line.name); };
  if (std::ranges::none_of(imported.others, is_joints)) {
    throw InputError(fmt::format(
        "{}: no joints are in the files, expected joints0 or joints_command0", plan.arm.string()));
  }
  imported.writers.emplace_back(
      [file = plan.arm, name = ArmFileName(plan)](const std::filesystem::path& folder) {
        WriteTextFile(folder / name, ReadTextFile(file));
      });
}

void TakeInstrument(ImportPlan& plan, Recording& recording, ImportLog& log) {
  if (!plan.mass_per_length_kg_m && recording.has_shaft) {
    plan.mass_per_length_kg_m = 0.0;
    log.Assume("instrument.mass_per_length_kg_m", "0: the shaft's own weight is not modelled");
  }
  if (!plan.gravity_m_s2) {
    plan.gravity_m_s2 = Eigen::Vector3d(0.0, 0.0, -9.81);
    log.Assume("gravity_m_s2", "0, 0, -9.81: R's z axis points up");
  }
  recording.gravity_m_s2 = *plan.gravity_m_s2;
  recording.tolerances = plan.tolerances;
  if (!recording.has_shaft) return;
  recording.instrument = {*plan.length_m, *plan.outer_diameter_m, *plan.bending_stiffness_Nm2,
                          *plan.mass_per_length_kg_m, plan.stiffness_taper.value_or(0.0)};
  recording.p_RP = *plan.p_RP;
}

// Clocks that differ by more than the recording is long leave streams without a common time.
void SayApart(const Recording& recording, ImportLog& log) {
  const auto streams = DescribeStreams(recording);
  for (std::size_t i = 1; i < streams.size(); ++i) {
    const auto &a = streams[0], &b = streams[i];
    if (a.first_ns <= b.last_ns && b.first_ns <= a.last_ns) continue;
    log.Warn(
        fmt::format("{} and {} have no time in common (they begin {:.6g} s apart): their clocks "
                    "differ, tell the offset of one",
                    a.name, b.name, 1e-9 * static_cast<double>(b.first_ns - a.first_ns)));
  }
}

}  // namespace

Imported Import(ImportPlan plan) {
  Imported imported;
  ImportLog& log = imported.log;
  log.assumed = std::exchange(plan.assumed, {});
  Streams streams;
  if (!IsOfArmAlone(plan)) log.Try([&] { NeedInstrument(plan); });
  if (!plan.session.empty()) AddDvrkSession(std::exchange(plan.session, {}), plan, log);
  FindTables(plan, log);
  FindTopics(plan, streams, log);
  if (IsOfArmAlone(plan)) KeepJoints(plan, log);
  log.Try([&] { NeedSettings(plan); });
  ReadTables(plan, streams, log);
  ReadBags(plan, streams, log);
  ReadVideos(plan, streams, log);
  log.RefuseMissing();

  imported.recording = std::move(streams.recording);
  imported.skipped = std::move(streams.skipped);
  imported.others = std::move(streams.others);
  imported.writers = std::move(streams.writers);
  if (!plan.arm.empty()) AddArm(plan, imported);
  TakeInstrument(plan, imported.recording, log);
  TakeSettings(plan, imported.recording, log);
  SayApart(imported.recording, log);
  plan.assumed = log.assumed;
  imported.plan = std::move(plan);
  return imported;
}

void WriteImported(const std::filesystem::path& folder, const Imported& imported) {
  WriteRecording(folder, imported.recording);
  for (const auto& write : imported.writers) write(folder);
  WriteTextFile(folder / kMappingName, MappingText(imported.plan));
}

}  // namespace flextip::exchange
