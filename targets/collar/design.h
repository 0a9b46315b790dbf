// A tag collar for a shaft: a prism whose faces carry a tag each, and whether all of it fits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tag_collar.h"

namespace flextip {

/// The wishes for a collar. Lengths in m.
struct CollarWishes {
  double shaft_diameter_m = 0.005;
  int faces = 6;
  std::string family = "tag36h11";
  std::vector<int> ids = {};  ///< one a face; empty: 0, 1, 2, ...
  /// Between the detected corners; absent: the largest that fits.
  std::optional<double> tag_size_m = {};
  std::optional<double> outer_m = {};  ///< largest diameter over the corners, the paper included
  double from_tip_m = 0.03;            ///< from the tags' middles to the tip
  double paper_m = 0.0001;             ///< thickness of the print on the faces
  double bore_clearance_m = 0.0001;    ///< bore less shaft, in diameter
};

/// A collar that fits. The mount is a prism about the shaft, x along the shaft toward the tip.
struct CollarDesign {
  CollarWishes wishes;
  TagCollar collar = {};    ///< tags on the paper's surface, in E; face i at angle 2 pi i / faces
  double tag_size_m = 0.0;  ///< between the detected corners
  double plate_m = 0.0;     ///< side of a tag with its white rim
  double cell_m = 0.0;      ///< side of a cell
  double bore_m = 0.0;      ///< diameter
  double across_m = 0.0;    ///< of the mount: twice the distance from the axis to a face
  double length_m = 0.0;    ///< of mount and strip, along the shaft
  double outer_m = 0.0;     ///< diameter over the corners with the paper: what a port must let pass
  double face_m = 0.0;      ///< width of a face on the paper's surface
  double strip_face_m = 0.0;  ///< width of a face on the flat strip, folded in the paper's middle
};

/// Returns a collar by the wishes.
/// - Without tag size and outer diameter: the largest tag (in steps of 0.1 mm) of a collar of 12 mm
///   over its corners, or of the least that the shaft allows.
/// - With one: the smallest collar for the tag, or the largest tag for the diameter.
/// - With both: the smallest collar for the tag.
/// Throws InputError where a wish is out of range, the family or an id does not exist, a tag with
/// its white rim is wider than a face, the walls are too thin, or the collar reaches past the tip.
CollarDesign DesignCollar(const CollarWishes& wishes);

/// Thinnest wall of a mount between bore and face (m).
inline constexpr double kLeastWall_m = 0.0008;

}  // namespace flextip
