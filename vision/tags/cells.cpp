#include "vision/tags/cells.h"

#include <apriltag/apriltag.h>

#include "core/error.h"
#include "vision/tags/families.h"

namespace flextip {
namespace {

// The ring of cells at `inset` from the square's rim.
void FillRing(TagCells& tag, int inset, TagCells::Colour colour) {
  const int last = tag.cells - 1 - inset;
  for (int i = inset; i <= last; ++i) {
    for (const auto& [column, row] :
         {std::pair{i, inset}, std::pair{i, last}, std::pair{inset, i}, std::pair{last, i}}) {
      tag.colours[static_cast<std::size_t>(row) * tag.cells + column] = colour;
    }
  }
}

}  // namespace

TagCells ReadTagCells(const std::string& family_name, int id) {
  const TagFamily family = MakeTagFamily(family_name);
  if (id < 0 || id >= static_cast<int>(family->ncodes)) {
    throw InputError(fmt::format("tag id: found {}, expected 0 to {} in {}", id, family->ncodes - 1,
                                 family_name));
  }
  TagCells tag;
  tag.cells = family->total_width;
  tag.border_cells = family->width_at_border;
  tag.colours.assign(static_cast<std::size_t>(tag.cells) * tag.cells, TagCells::kUnknown);
  const int start = (tag.cells - tag.border_cells) / 2;  // the first cell within the border
  const bool reversed = family->reversed_border;         // white inside, black around
  FillRing(tag, start, reversed ? TagCells::kWhite : TagCells::kBlack);
  FillRing(tag, start - 1, reversed ? TagCells::kBlack : TagCells::kWhite);
  for (std::uint32_t bit = 0; bit < family->nbits; ++bit) {
    const bool white = family->codes[id] >> (family->nbits - bit - 1) & 1;
    const int column = static_cast<int>(family->bit_x[bit]) + start;
    const int row = static_cast<int>(family->bit_y[bit]) + start;
    tag.colours[static_cast<std::size_t>(row) * tag.cells + column] =
        white ? TagCells::kWhite : TagCells::kBlack;
  }
  return tag;
}

}  // namespace flextip
