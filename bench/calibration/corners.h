// One set of corners that every peer calibrates from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/boards/board.h"
#include "core/camera.h"

namespace flextip::bench {

/// Pictures of one board by one camera, as corners.
struct CornerSet {
  BoardSpec board;
  int width_px = 0, height_px = 0;
  double working_distance_m = 0;  ///< at which the uncertainty is compared
  double focal_px = 0;            ///< a rough one, for peers that want a start
  std::vector<std::string> names;
  std::vector<BoardSighting> seen;  ///< views of `names`; views without a board have no corners
};

/// Corners of pictures, all of one size. Throws InputError for other sizes.
CornerSet DetectCorners(const std::vector<std::filesystem::path>& images, const BoardSpec& board);

/// `set.json` and `corners.vnl`, which mrcal reads, in `folder`.
void WriteCorners(const std::filesystem::path& folder, const CornerSet& set);
/// Throws InputError where a file is absent or says something else than WriteCorners would.
CornerSet ReadCorners(const std::filesystem::path& folder);

/// Every other view that has corners, from the first (`half` 0) or the second (1) on.
CornerSet HalfOf(const CornerSet& set, int half);

}  // namespace flextip::bench
