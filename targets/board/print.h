// A calibration board on a page, to print to scale.
#pragma once

#include <filesystem>

#include "calibration/boards/face.h"
#include "targets/print/sheet.h"

namespace flextip {

/// The place of a board on a sheet.
struct BoardOnPaper {
  Paper paper;                ///< as it lies: upright or turned
  Eigen::Vector2d origin_mm;  ///< frame B's origin, from the upper left corner
};

/// Returns the board in the middle of the paper, turned where it fits so alone. Throws InputError
/// with the way out where the board and its white margin do not fit.
BoardOnPaper PlaceBoard(const BoardFace& face, const Paper& paper);

/// Draws the board with rulers, its name (`spec`, as calibrate camera reads it) and what to do.
/// Throws WorkError where the disk refuses.
void PrintBoard(const BoardFace& face, const BoardOnPaper& place, const std::string& spec,
                const std::filesystem::path& file);

}  // namespace flextip
