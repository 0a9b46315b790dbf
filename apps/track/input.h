// Where flextip track takes frames, camera and collar from.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/calibration_input.h"
#include "recording/frames/frame_sets.h"
#include "recording/frames/frame_source.h"
#include "recording/recording.h"

namespace flextip {

struct TrackInputOptions {
  std::filesystem::path source;          ///< a recording, a folder of pictures, a video
  std::string live;                      ///< instead of it: a device number, URL or file
  std::filesystem::path camera, collar;  ///< files; needed but for a recording
  std::optional<double> rate_hz;         ///< of pictures or a video
  GreyRange range;
  CalibrationFiles calibrations;
};

struct TrackInput {
  Recording recording;  ///< with cam0 (its calibration at least) and tags0;
                        ///< cam1 only where its frames are there
  bool is_recording = false;
  std::unique_ptr<FrameSets> frames;
  std::vector<std::string> warnings;
  std::vector<UsedCalibration> calibrations;  ///< already in `recording`
};

/// Throws InputError.
TrackInput OpenTrackInput(const TrackInputOptions& options);

}  // namespace flextip
