// Grey values of colour pixels, everywhere the same.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/image.h"

namespace flextip {

/// Returns the grey value (0 to 255, rounded) of a pixel `bgr` = blue, green, red, with the weights
/// of Rec. 601.
inline std::uint8_t GreyOf(const std::uint8_t* bgr) {
  return static_cast<std::uint8_t>((bgr[0] * 1868 + bgr[1] * 9617 + bgr[2] * 4899 + 8192) >> 14);
}

/// Returns the grey value of the pixel (x, y) of an image with 1 or 3 channels. Colour is not
/// rounded.
inline float GreyAt(const Image& image, int x, int y) {
  const std::uint8_t* at = image.Row(y) + static_cast<std::ptrdiff_t>(x) * image.channels;
  const auto value = [at](int channel) { return static_cast<float>(at[channel]); };
  return image.channels == 1 ? value(0) : 0.114f * value(0) + 0.587f * value(1) + 0.299f * value(2);
}

}  // namespace flextip
