// Frames one after another: of a recording's camera, a folder of pictures, a video, a live camera.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/time_series.h"
#include "recording/frames/frames.h"
#include "recording/recording.h"

namespace flextip {

struct Frame {
  TimeNs t_ns = 0;
  Image image;  ///< grey, or blue, green, red
};

/// One frame is held at a time. A frame of another size than the camera's is an InputError.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  /// Returns the number of frames in the source; 0: not known.
  virtual std::size_t Count() const = 0;
  /// Returns the next frame; empty after the last, and where a video ends early. Throws InputError
  /// for an unreadable frame.
  virtual std::optional<Frame> Next() = 0;
  /// Passes over the next `frames` without decoding them where that can be helped.
  virtual void Skip(std::size_t frames) = 0;

 protected:
  FrameSource() = default;
};

/// Opens the frames of RECORDING/`name` ("cam0"). Throws InputError where there are none or the
/// video cannot be opened.
std::unique_ptr<FrameSource> OpenRecordedFrames(const std::filesystem::path& recording,
                                                const std::string& name, const CameraStream& camera,
                                                const GreyRange& range = {});

/// Opens a folder of PNG, JPEG or TIFF files or a video. Stamps frames from 0 on by `rate_hz`.
/// Where that is empty, stamps by the files' names if those are nanoseconds, else by the video's
/// own rate or the camera's.
std::unique_ptr<FrameSource> OpenPlainFrames(const std::filesystem::path& source,
                                             const CameraCalibration& camera,
                                             const std::optional<double>& rate_hz,
                                             const GreyRange& range = {});

/// Returns the times and names of the pictures in a folder, as OpenPlainFrames takes them: in the
/// order of the numbers in their names. Names are nanoseconds where all are whole numbers at least
/// 0.1 ms apart.
Series<std::string> PicturesInFolder(const std::filesystem::path& folder, double rate_hz,
                                     bool times_from_names);

/// Returns the pictures that paths stand for: a folder stands for its PNG, JPEG and TIFF files in
/// the order of the numbers in their names. Throws InputError for a folder without any.
std::vector<std::filesystem::path> PictureFiles(const std::vector<std::filesystem::path>& paths);

/// Opens a device number, a URL, a pipe, or a video file, which then gives its frames at its own
/// rate. Stamps by the clock (nanoseconds since 1970).
std::unique_ptr<FrameSource> OpenLiveFrames(const std::string& source,
                                            const CameraCalibration& camera);

}  // namespace flextip
