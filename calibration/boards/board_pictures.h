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

/// Finds the corners in every picture; holds a single picture at a time. A charuco layout told by a
/// picture holds for all. Throws InputError for pictures of several sizes, for none, and for a
/// `corners` file of another board or without one of the images. Calls `progress` with the number
/// of pictures done and their total.
CornersFile CornersOf(const BoardPictures& pictures,
                      const std::function<void(std::size_t done, std::size_t all)>& progress = {});

}  // namespace flextip
