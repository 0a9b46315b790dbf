// Pictures and videos as files.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/image.h"

namespace flextip {

/// Which values of 16-bit pictures become 0 and 255; 8-bit ones stay as they are.
struct GreyRange {
  double black = 0.0, white = 65535.0;
};

/// Reads a picture in blue, green, red with 8 bits. Throws InputError naming the file where it is
/// missing, empty, cut off or no picture, and for pixels of other than 8 or 16 bits.
Image ReadImageFile(const std::filesystem::path& file);

/// Reads the same, with a single channel where the file has a single channel.
Image ReadGreyOrColour(const std::filesystem::path& file, const GreyRange& range = {});

/// Returns a copy with three channels.
Image ToColour(const Image& image);

/// Keeps the video library's own messages off stderr. Before the first video is opened.
void SilenceVideoCodecs();

/// Throws WorkError where the disk refuses.
void WritePng(const std::filesystem::path& file, const Image& image);

/// Returns the picture as the bytes of a JPEG file, `quality` 0 to 100, scaled down to
/// `most_width_px` where it is wider. Throws WorkError where it is empty.
std::string EncodeJpeg(const Image& image, int quality, int most_width_px);

/// A video written frame by frame: H.264, or VP9 where there is no encoder of it, else MPEG-4
/// part 2. A file not closed by Finish is of no use.
class VideoFile {
 public:
  /// Takes the name of an MP4 file.
  VideoFile(const std::filesystem::path& file, double rate_hz);
  ~VideoFile();
  /// Throws WorkError where no encoder is there or the disk refuses.
  void Add(const Image& image);
  void Finish();
  /// Returns whether browsers play the file; true before the first frame.
  bool PlaysInBrowsers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The codecs write their complaints straight to stderr; the caller reports them in one line.
class QuietStderr {
 public:
  QuietStderr();
  ~QuietStderr();
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;

 private:
  int saved_;
};

}  // namespace flextip
