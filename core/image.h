// A picture in memory, as the renderer makes it and vision reads it.
#pragma once

#include <cstdint>
#include <vector>

namespace flextip {

/// Rows of interleaved 8-bit channels (1: grey; 3: blue, green, red), no padding.
struct Image {
  int width_px = 0, height_px = 0, channels = 1;
  std::vector<std::uint8_t> data;

  Image() = default;
  Image(int width, int height, int channel_count)
      : width_px(width),
        height_px(height),
        channels(channel_count),
        data(static_cast<std::size_t>(width) * height * channel_count) {}
  bool Empty() const { return data.empty(); }
  const std::uint8_t* Row(int y) const {
    return data.data() + static_cast<std::size_t>(y) * width_px * channels;
  }
  std::uint8_t* Row(int y) {
    return data.data() + static_cast<std::size_t>(y) * width_px * channels;
  }
};

}  // namespace flextip
