// What a video file holds.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace flextip {

struct VideoInfo {
  int width_px = 0, height_px = 0;
  double rate_hz = 0.0;    ///< as the file states it; 0: it does not
  std::size_t frames = 0;  ///< counted: what a file states may be off
};

/// Returns whether the first bytes are those of a video's container. A list of other files or
/// addresses, which the video library would open, is none.
bool IsVideo(const std::filesystem::path& file);

/// Returns the rate that a video file states, 0 where no camera has such a rate.
double PossibleRate(double stated_hz);

/// Throws InputError where a video states more pixels than any camera has. Before its first frame.
void RefuseHugeVideo(const std::string& file, double width_px, double height_px);

/// Throws InputError where the file is missing, is no video or holds no frame.
VideoInfo ReadVideoInfo(const std::filesystem::path& file);

}  // namespace flextip
