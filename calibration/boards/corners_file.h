// Detected corners as a text file: calibration can start from there, without the pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/boards/board.h"

namespace flextip {

/// The corners of a board in a camera's pictures.
struct CornersFile {
  std::string board;  ///< as ParseBoardSpec reads it
  int width_px = 0, height_px = 0;
  std::vector<BoardView> views;  ///< also those in which no board was found
};

/// Lines of text (docs/formats.md):
///   #flextip-corners 1
///   #board chessboard:9x6:0.025
///   #resolution 640 480
///   #image,id [],x [px],y [px]
///   left01.jpg,0,244.4,94.1
///   left04.jpg,,,no chessboard with 9x6 inner corners found
/// Images in the order of the file, their corners by ascending id. Throws InputError with file and
/// line for anything else, for an id that the board does not have or that comes twice, and for
/// numbers that are not finite.
CornersFile ReadCorners(const std::filesystem::path& file);

/// Writes every number exactly. Throws WorkError where the disk refuses, InputError for an image's
/// name with a line break.
void WriteCorners(const std::filesystem::path& file, const CornersFile& corners);

}  // namespace flextip
