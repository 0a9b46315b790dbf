// The black and white cells of an AprilTag, from the AprilTag library.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace flextip::simulation {

/// A square of `cells` x `cells`, the tag as it is read (x right, y down), with its white margin.
/// The side between the detected corners spans `border_cells` of them, centred.
struct TagPattern {
  int cells = 0;
  int border_cells = 0;
  std::vector<std::uint8_t> white;  ///< rows from the top; 1 white, 0 black

  /// The colour at (u, v) in cells from the tag's centre; white outside the pattern.
  bool WhiteAt(double u, double v) const {
    const int column = Cell(u), row = Cell(v);
    return !Inside(column) || !Inside(row) || white[static_cast<std::size_t>(row) * cells + column];
  }
  int Cell(double u) const { return static_cast<int>(u + 0.5 * cells + 64.0) - 64; }
  bool Inside(int cell) const { return cell >= 0 && cell < cells; }
};

/// @throws InputError where the family is not known or has no tag of that id.
TagPattern MakeTagPattern(const std::string& family, int id);

}  // namespace flextip::simulation
