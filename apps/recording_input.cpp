#include "apps/recording_input.h"

#include "recording/sensor_streams.h"

namespace flextip {

void AddRecordingInput(CLI::App& command, RecordingInput& input) {
  command.add_option("recording", input.recording, "Folder of the recording")
      ->required()
      ->type_name("RECORDING");
  command.add_option("-o,--output", input.out, "Folder for the results")
      ->required()
      ->type_name("OUT");
  command.add_option("--tracked", input.tracked,
                     "Take the tip from this result of flextip track instead of vision0");
}

ReadResult ReadInput(const RecordingInput& input) {
  ReadResult read = ReadRecording(input.recording, {.check_frames = false});
  if (!input.tracked.empty()) {
    ReadLog log;
    read.recording.vision0 = ReadVision(input.tracked / "vision0", log);
    read.warnings.insert(read.warnings.end(), log.warnings.begin(), log.warnings.end());
  }
  return read;
}

}  // namespace flextip
