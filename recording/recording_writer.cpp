#include "recording/recording_writer.h"

#include "recording/arm/arm_file.h"
#include "recording/recording_file.h"
#include "recording/streams/sensor_streams.h"

namespace flextip {

void WriteRecording(const std::filesystem::path& folder, const Recording& recording) {
  if (recording.wrist0) WriteWrist(folder / "wrist0", *recording.wrist0);
  if (recording.command0) WriteCommand(folder / "command0", *recording.command0);
  if (recording.em0) WriteEm(folder / "em0", *recording.em0);
  if (recording.em1) WriteEm(folder / "em1", *recording.em1);
  if (recording.strain0) WriteStrain(folder / "strain0", *recording.strain0);
  if (recording.load0) WriteLoad(folder / "load0", *recording.load0);
  if (recording.cam0) WriteCamera(folder / "cam0", *recording.cam0);
  if (recording.cam1) WriteCamera(folder / "cam1", *recording.cam1);
  if (recording.tags0) WriteTags(folder / "tags0", *recording.tags0);
  if (recording.vision0) WriteVision(folder / "vision0", *recording.vision0);
  if (recording.arm) WriteArm(folder / "arm.yaml", *recording.arm);
  if (recording.joints0) WriteJoints(folder / "joints0", *recording.joints0);
  if (recording.joints_command0)
    WriteJoints(folder / "joints_command0", *recording.joints_command0);
  if (recording.joints_seen0) WriteJoints(folder / "joints_seen0", *recording.joints_seen0);
  if (recording.torque0) WriteTorque(folder / "torque0", *recording.torque0);
  if (recording.pose0) WritePose(folder / "pose0", *recording.pose0);
  // Last, since a folder without it does not read as a recording.
  WriteRecordingFile(folder / "recording.yaml", recording);
}

}  // namespace flextip
