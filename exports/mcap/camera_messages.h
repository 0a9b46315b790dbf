// A recording's camera: its pictures as messages, and what was seen drawn over them.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/camera.h"
#include "exports/mcap/messages.h"
#include "recording/frames/frame_source.h"
#include "recording/recording.h"

namespace flextip::exports {

class RecordedCamera {
 public:
  RecordedCamera(std::filesystem::path recording, std::string name, CameraStream stream);

  const std::string& Name() const { return name_; }
  const CameraCalibration& Calibration() const { return stream_.calibration; }
  const std::vector<TimeNs>& Times() const { return times_; }

  /// Returns the picture of that time as a message: a file's bytes as they are, a video's frame as
  /// JPEG. Frames of a video must be asked for in their order. Throws InputError for a frame that
  /// cannot be read.
  std::string NextImage(TimeNs t_ns);

  /// Returns what the tables know of that time: tags by their corners (tags0), the tip and the
  /// shaft's last 20 mm (p_RE and d_RE of vision0 or of a result's).
  Annotations Annotate(const std::vector<TimedTable>& tables, TimeNs t_ns) const;

 private:
  std::filesystem::path recording_;
  std::string name_;
  CameraStream stream_;
  std::vector<TimeNs> times_;
  std::unique_ptr<FrameSource> video_;
};

/// Returns the cameras of a recording that kept pictures; none where the folder is no recording.
std::vector<RecordedCamera> CamerasOf(const std::filesystem::path& folder);

}  // namespace flextip::exports
