// The pictures of a video, one after another.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/image.h"
#include "recording/text/bounds.h"

namespace flextip {

/// Reads a video by FFmpeg's libraries. OpenCV's reader of them copies from beyond a picture where
/// the stream is smaller than its container states.
class VideoReader {
 public:
  /// A file ends at its first damaged picture: with one left out, all later ones have another
  /// picture's number. A stream (a pipe, an address) goes on after it.
  enum class Kind { kFile, kStream };

  /// Opens `source`. Returns nothing where it is no video that can be read, or a list of other
  /// files. Throws InputError where it states more pixels than any camera has. Pictures of more
  /// than `most_pixels` are not decoded. FFmpeg's libraries print nothing from then on.
  static std::unique_ptr<VideoReader> Open(const std::string& source, Kind kind = Kind::kFile,
                                           double most_pixels = kMostPixels);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  /// Return the size as it is shown, by the container.
  int Width_px() const;
  int Height_px() const;
  /// Returns the frames per second that the container states; 0 where it states none.
  double StatedRate() const;
  /// Returns the number of frames that the container states, often made of its duration.
  double StatedFrames() const;

  /// Decodes the next picture. Returns false after the last.
  bool Advance();
  /// Returns the picture that was decoded last, in blue, green, red, upright, of its own size;
  /// nothing where it cannot be converted. After an Advance that returned true.
  std::optional<Image> Picture();

 private:
  struct Impl;
  explicit VideoReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip
