#include "calibration/boards/board_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.h"
#include "recording/frames/frames.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using TellProgress = std::function<void(std::size_t, std::size_t)>;

Image ReadSized(const fs::path& file, const CornersFile& corners) {
  Image image = ReadImageFile(file);
  if (!corners.views.empty() &&
      (image.width_px != corners.width_px || image.height_px != corners.height_px)) {
    throw InputError::At(
        file.string(), 0,
        fmt::format("expected {}x{} pixels as in {}, found {}x{}", corners.width_px,
                    corners.height_px, corners.views[0].name, image.width_px, image.height_px));
  }
  return image;
}

// Pictures that did not tell a charuco board's layout, once others have.
void DetectAgain(const BoardPictures& pictures, BoardSpec board, CornersFile& corners) {
  const auto telling =
      std::find_if(corners.views.begin(), corners.views.end(),
                   [](const BoardView& v) { return v.sighting.layout != CharucoLayout::kUnknown; });
  if (board.kind != BoardKind::kCharuco || telling == corners.views.end()) return;
  board.layout = telling->sighting.layout;
  for (std::size_t i = 0; i < corners.views.size(); ++i) {
    BoardSighting& seen = corners.views[i].sighting;
    if (seen.layout == board.layout) continue;
    seen = DetectBoard(ReadSized(pictures.images[i], corners), board);
  }
}

// Finds the board in every picture; only one picture is held at a time.
CornersFile Detect(const BoardPictures& pictures, const BoardSpec& board,
                   const TellProgress& progress) {
  if (pictures.images.empty()) throw InputError("no images to find the board in");
  CornersFile corners{.board = pictures.board, .width_px = 0, .height_px = 0, .views = {}};
  for (const fs::path& file : pictures.images) {
    const Image image = ReadSized(file, corners);
    corners.width_px = image.width_px;
    corners.height_px = image.height_px;
    corners.views.push_back({file.string(), DetectBoard(image, board)});
    if (progress) progress(corners.views.size(), pictures.images.size());
  }
  DetectAgain(pictures, board, corners);
  return corners;
}

// What was detected before, of the images named, or of all where none is.
CornersFile Reload(const BoardPictures& pictures) {
  CornersFile corners = ReadCorners(pictures.corners);
  if (corners.board != pictures.board) {
    throw InputError::At(
        pictures.corners.string(), 2,
        fmt::format("is of board '{}', not of '{}'", corners.board, pictures.board));
  }
  if (pictures.images.empty()) return corners;
  std::map<std::string, BoardView> by_name;
  for (const BoardView& view : corners.views) by_name[view.name] = view;
  corners.views.clear();
  for (const fs::path& image : pictures.images) {
    const auto it = by_name.find(image.string());
    if (it == by_name.end()) {
      throw InputError::At(pictures.corners.string(), 0,
                           fmt::format("has no image '{}'", image.string()));
    }
    corners.views.push_back(it->second);
  }
  return corners;
}

}  // namespace

CornersFile CornersOf(const BoardPictures& pictures, const TellProgress& progress) {
  const BoardSpec board = ParseBoardSpec(pictures.board);
  if (!pictures.corners.empty() && fs::exists(pictures.corners)) return Reload(pictures);
  const CornersFile corners = Detect(pictures, board, progress);
  if (!pictures.corners.empty()) WriteCorners(pictures.corners, corners);
  return corners;
}

}  // namespace flextip
