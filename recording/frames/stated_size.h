// The size that a picture's first bytes state, so that an absurd one is refused before any memory
// is asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

namespace flextip {

/// Returns `count` bytes of a file from the place `from` on, fewer where it ends before.
std::string ReadBytes(std::ifstream& in, std::streamoff from, std::streamsize count);

struct StatedSize {
  std::int64_t width_px = 0, height_px = 0;
};

/// Reads the size that a BMP, a PGM or PPM, or a TIFF file states. Empty for other kinds, and where
/// it states none.
std::optional<StatedSize> ReadStatedSize(const std::filesystem::path& file);

}  // namespace flextip
