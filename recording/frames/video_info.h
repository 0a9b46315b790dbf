// What a video file holds.
#pragma once

#include <cstddef>
#include <filesystem>

namespace flextip {

struct VideoInfo {
  int width_px = 0, height_px = 0;
  double rate_hz = 0.0;    ///< as the file states it; 0: it does not
  std::size_t frames = 0;  ///< counted: what a file states may be off
};

/// Throws InputError where the file is missing, is no video or holds no frame.
VideoInfo ReadVideoInfo(const std::filesystem::path& file);

}  // namespace flextip
