// The frames of a rendered run as files.
#pragma once

#include <filesystem>

#include "core/image.h"
#include "recording/recording.h"

namespace flextip {

/// Frames below `folder`: all of them without loss, or none; the last as a picture to look at in
/// both cases.
class FrameFiles {
 public:
  /// Makes the folders.
  FrameFiles(const std::filesystem::path& folder, bool keep);
  /// Throws WorkError where the disk refuses.
  void Add(TimeNs t_ns, const Image& image);
  /// Writes the last frame; takes the names of files that are not kept out of the recording.
  void Finish(Recording& recording) const;

 private:
  std::filesystem::path folder_;
  bool keep_;
  Image last_;
};

}  // namespace flextip
