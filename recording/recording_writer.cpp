#include "recording/recording_writer.h"

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
  // Last, since a folder without it does not read as a recording.
  WriteRecordingFile(folder / "recording.yaml", recording);
}

}  // namespace flextip
