// Options of flextip track and the input they name.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/command_paths.h"
#include "apps/common/input/calibration_input.h"
#include "recording/frames/track_input.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {

struct TrackOptions {
  std::filesystem::path source;          ///< a recording, a folder of pictures, a video
  std::string live;                      ///< instead: a device number or URL
  std::filesystem::path camera, collar;  ///< files, for all but a recording
  double rate_hz = 0.0;                  ///< rate of pictures or a video; 0: not given
  std::vector<double> black_white;       ///< levels in 16-bit pictures; empty: not given
  CalibrationFiles calibrations;
  std::filesystem::path out, truth;
  TrackerOptions tracker;
  std::string end;          ///< the shaft's end, "round" or "flat", where the outline is used
  double diameter_m = 0.0;  ///< the shaft's diameter; 0: the recording's
  long max_frames = 0;      ///< 0: all
  bool no_model = false, overlay = false, force = false, resume = false, no_check = false;
  bool until_stopped = false;  ///< --live was given: Ctrl-C ends the run with its results

  /// Forgets camera, collar and rate of a defaults file where the source is a recording.
  void LeaveDefaultsOfPlainPictures();

  /// Whether the source has its own camera, collar and times.
  bool IsRecording() const;
  std::string InputName() const;
  /// Names the input with its calibrations: a resumed run must have the same.
  std::string RunName() const;
  /// Returns every file and folder that is read.
  std::vector<std::filesystem::path> Files() const;
  /// The paths of the input, for commands to copy: the recording, or the first of the pictures.
  CommandPaths Paths() const;
};

/// Adds all options and the examples. `options` must outlive the parsing.
void AddTrackOptions(CLI::App& command, TrackOptions& options);

/// Fills `options.tracker`, takes a file given as live for what it is, and throws InputError for
/// options that contradict each other.
void CheckTrackOptions(TrackOptions& options);

/// Opens the input that the checked options name. Throws InputError.
TrackInput OpenTrackInput(const TrackOptions& options);

}  // namespace flextip
