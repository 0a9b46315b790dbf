// A board's corners in one camera's pictures, or as they were detected before.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calibration/boards/corners_file.h"

namespace flextip {

struct BoardPictures {
  std::vector<std::filesystem::path> images = {};  ///< none: all that `corners` has
  std::string board;                               ///< as ParseBoardSpec reads it
  std::filesystem::path corners = {};  ///< read where it exists, else written; empty: neither
};

/// One picture is held at a time. What one picture tells of a charuco board's layout holds for all.
/// Throws InputError for pictures of several sizes, for none, and for a `corners` file of another
/// board or without one of the images.
/// `progress` is told how many pictures were looked at, of how many.
CornersFile CornersOf(const BoardPictures& pictures,
                      const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace flextip
