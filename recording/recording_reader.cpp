#include "recording/recording_reader.h"

#include <set>
#include <system_error>

#include "core/error.h"
#include "recording/recording_file.h"
#include "recording/streams/sensor_streams.h"

namespace flextip {
namespace {

const std::set<std::string> kKnownFolders = {
    "wrist0",  "command0",        "em0",          "em1",     "strain0",  "load0", "cam0",
    "cam1",    "tags0",           "vision0",      "truth0",  "session0", "loop0", "stops",
    "joints0", "joints_command0", "joints_seen0", "torque0", "pose0"};

void WarnOfUnknownFolders(const std::filesystem::path& folder, ReadLog& log) {
  std::set<std::string> unknown;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory() || name.starts_with('.') || kKnownFolders.contains(name)) continue;
    unknown.insert(name);
  }
  for (const auto& name : unknown) {
    log.warnings.push_back(
        fmt::format("{}: not a known sensor, ignored", (folder / name).string()));
  }
}

void ReadStreams(const std::filesystem::path& folder, const ReadOptions& options,
                 Recording& recording, ReadLog& log) {
  const double length_m = recording.instrument.length_m;
  const auto has = [&](const char* sensor) {
    return std::filesystem::is_directory(folder / sensor);
  };
  if (has("wrist0")) recording.wrist0 = ReadWrist(folder / "wrist0", log);
  if (has("command0")) recording.command0 = ReadCommand(folder / "command0", log);
  if (has("em0")) recording.em0 = ReadEm(folder / "em0", length_m, false, log);
  if (has("em1")) recording.em1 = ReadEm(folder / "em1", length_m, true, log);
  if (has("strain0")) recording.strain0 = ReadStrain(folder / "strain0", length_m, log);
  if (has("load0")) recording.load0 = ReadLoad(folder / "load0", log);
  if (has("cam0")) recording.cam0 = ReadCamera(folder / "cam0", options.check_frames, log);
  if (has("cam1")) recording.cam1 = ReadCamera(folder / "cam1", options.check_frames, log);
  if (has("tags0")) recording.tags0 = ReadTags(folder / "tags0", log);
  if (has("vision0")) recording.vision0 = ReadVision(folder / "vision0", log);
  recording.arm = ReadArmOf(folder, log);
  if (!recording.arm) return;
  const Arm& arm = *recording.arm;
  if (has("joints0")) recording.joints0 = ReadJoints(folder / "joints0", arm, log);
  if (has("joints_command0"))
    recording.joints_command0 = ReadJoints(folder / "joints_command0", arm, log);
  if (has("joints_seen0")) recording.joints_seen0 = ReadJoints(folder / "joints_seen0", arm, log);
  if (has("torque0")) recording.torque0 = ReadTorque(folder / "torque0", arm, log);
  if (has("pose0")) recording.pose0 = ReadPose(folder / "pose0", log);
}

/// A shaft may be absent where an arm's joints were recorded and nothing that a shaft needs.
bool MayLackShaft(const std::filesystem::path& folder) {
  const auto has = [&](const char* sensor) {
    return std::filesystem::is_directory(folder / sensor);
  };
  if (!has("joints0") && !has("joints_command0")) return false;
  for (const char* sensor : {"wrist0", "em0", "em1", "strain0", "load0", "vision0"})
    if (has(sensor)) return false;
  return true;
}

}  // namespace

ReadResult ReadRecording(const std::filesystem::path& folder, const ReadOptions& options) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw InputError::At(folder.string(), 0, "no such folder, expected a recording");
  }
  ReadLog log;
  ReadResult result;
  try {
    result.recording = ReadRecordingFile(folder / "recording.yaml", log, MayLackShaft(folder));
    ReadStreams(folder, options, result.recording, log);
    WarnOfUnknownFolders(folder, log);
  } catch (const std::filesystem::filesystem_error& problem) {
    throw InputError::At(problem.path1().string(), 0,
                         fmt::format("cannot be read: {}", problem.code().message()));
  }
  result.warnings = std::move(log.warnings);
  result.torn_lines = log.torn_lines;
  result.dropped_frames = log.dropped_frames;
  return result;
}

}  // namespace flextip
