// The black and white cells of a tag.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace flextip {

/// The cells of a tag: a square of `cells` x `cells`, the tag as it is read (x right, y down). The
/// side between the detected corners spans `border_cells` of them, centred.
struct TagCells {
  enum Colour : std::uint8_t { kBlack, kWhite, kUnknown };  ///< unknown: not part of the tag

  int cells = 0;
  int border_cells = 0;
  std::vector<Colour> colours;  ///< rows from the top

  Colour At(int column, int row) const {
    const bool inside = column >= 0 && row >= 0 && column < cells && row < cells;
    return inside ? colours[static_cast<std::size_t>(row) * cells + column] : kUnknown;
  }
};

/// Returns the cells of a tag from the AprilTag library, with the white ring that the detector
/// needs. Throws InputError where the family is not known or has no tag of that id.
TagCells ReadTagCells(const std::string& family, int id);

}  // namespace flextip
