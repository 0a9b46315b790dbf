// An image file's size, from its first bytes: checking a recording of thousands of frames must not
// take as long as decoding them.
#pragma once

#include <filesystem>
#include <string>

namespace flextip {

struct ImageHead {
  int width_px = 0, height_px = 0;
  std::string problem;  ///< empty where the file looks whole: "is missing", "is cut off"
};

/// PNG and JPEG by their first and last bytes; BMP, PGM, PPM and TIFF by decoding them where they
/// state a size within bounds. Other kinds are no images here. Damage between the first and the
/// last bytes of a PNG or JPEG shows only when the image is decoded.
ImageHead ReadImageHead(const std::filesystem::path& file);

}  // namespace flextip
