// Opens what tracking needs: frames, camera and collar, of a recording or of plain files.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/calibrations/apply.h"
#include "recording/frames/frame_sets.h"
#include "recording/frames/frame_source.h"
#include "recording/recording.h"

namespace flextip {

/// Frames with the instrument they show.
struct TrackInput {
  Recording recording;  ///< with tags0 and cam0; cam1 only where its frames are there; no vision0
  std::unique_ptr<FrameSets> frames;
  std::vector<std::string> warnings;
  std::vector<UsedCalibration> calibrations;  ///< already in `recording`
};

/// What every kind of input takes.
struct TrackInputOptions {
  GreyRange range = {};                                  ///< of 16-bit pictures
  std::vector<std::filesystem::path> calibrations = {};  ///< calibration.yaml files, in their order
};

/// Camera and collar of frames that are no recording.
struct CameraFiles {
  std::filesystem::path camera = {};   ///< EuRoC, Kalibr, ROS or OpenCV
  std::filesystem::path collar = {};   ///< as a recording's tags0
  std::optional<double> rate_hz = {};  ///< in place of the file's or the names' own times
};

/// Opens a recording's frames: both cameras where both have frames, paired by their times. Throws
/// InputError, also without cam0 or tags0.
TrackInput OpenRecordingToTrack(const std::filesystem::path& recording,
                                const TrackInputOptions& options = {});

/// Opens a folder of pictures or a video (OpenPlainFrames). Throws InputError.
TrackInput OpenPicturesToTrack(const std::filesystem::path& source, const CameraFiles& files,
                               const TrackInputOptions& options = {});

/// Opens a live camera (OpenLiveFrames). Throws InputError.
TrackInput OpenCameraToTrack(const std::string& source, const CameraFiles& files,
                             const TrackInputOptions& options = {});

}  // namespace flextip
