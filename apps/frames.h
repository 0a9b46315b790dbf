// Pictures from files: single ones, and the frames of a recording's camera.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/image.h"
#include "core/time_series.h"
#include "recording/recording.h"

namespace flextip {

/// The picture in blue, green, red. Throws InputError naming the file where it is missing, empty,
/// cut off or no picture.
Image ReadImageFile(const std::filesystem::path& file);

/// Keeps the video library's own messages off stderr. Before the first video is opened.
void SilenceVideoCodecs();

/// Throws WorkError where the disk refuses.
void WritePng(const std::filesystem::path& file, const Image& image);

struct Frame {
  TimeNs t_ns = 0;
  Image image;  ///< blue, green, red
};

/// The frames of RECORDING/cam0 one after another, from image files or a video.
class FrameReader {
 public:
  /// Throws InputError where there are no frames or the video cannot be opened.
  FrameReader(const std::filesystem::path& recording, const CameraStream& camera);
  ~FrameReader();

  std::size_t Count() const;
  /// The next frame; empty after the last, and where a video ends before its last frame number.
  /// Throws InputError for an unreadable frame.
  std::optional<Frame> Next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A video written frame by frame. What was not closed by Finish is of no use.
class VideoFile {
 public:
  VideoFile(const std::filesystem::path& file, double rate_hz);
  ~VideoFile();
  /// Throws WorkError where no encoder is there or the disk refuses.
  void Add(const Image& image);
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
