#include "recording/calibrations/calibrated_recording.h"

#include "recording/streams/sensor_streams.h"

namespace flextip {

CalibratedRecording ReadCalibrated(const std::filesystem::path& folder,
                                   const CalibratedReadOptions& options) {
  CalibratedRecording read{ReadRecording(folder, {.check_frames = options.check_frames}), {}};
  Recording& recording = read.recording;
  const bool tracked = !options.tracked.empty();
  if (tracked) recording.vision0.reset();
  read.calibrations = ApplyCalibrations(options.calibrations, recording, read.warnings);
  if (!tracked) return read;
  ReadLog log;
  recording.vision0 = ReadVision(options.tracked / "vision0", log);
  read.warnings.insert(read.warnings.end(), log.warnings.begin(), log.warnings.end());
  for (const UsedCalibration& used : read.calibrations) {
    StateRegistrationNoise(used.calibration, *recording.vision0);
  }
  return read;
}

}  // namespace flextip
