// Which pixels of a tag take part in a fit.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "core/image.h"
#include "vision/photometric/blurred_pattern.h"
#include "vision/photometric/face_rows.h"
#include "vision/photometric/lens_map.h"

namespace flextip {

/// A tag's surroundings in a picture, and what to take of them. Places on the tag are in cells from
/// its top left corner.
struct TagRegion {
  int x0, y0, x1, y1;  ///< the pixels around the tag, ends included
  /// Places of the tag with its surroundings in the picture: rows by v, columns by u, at the
  /// beginning, the middle and the end.
  std::array<std::array<Eigen::Vector2d, 3>, 3> places_px;
  Eigen::Matrix3f to_tag;             ///< of FaceModel
  Eigen::Vector4f limits;             ///< u low, u high, v low, v high
  float unknown_u, unknown_v;         ///< to keep from cells that are not known
  float edge_u, edge_v;               ///< how far from an edge pixels say something, less than one
  int stride = 1;                     ///< every so many-th pixel in both directions
  int samples = 0, flat_samples = 0;  ///< drawn along edges and elsewhere; 0: all pixels
};

/// Returns the limits (as in TagRegion) without what is too near to cells that are not known.
Eigen::Vector4f LimitsWithin(const TagRegion& region, const BlurredPattern& pattern);

/// Takes the pixels near the edges between black and white, and every eighth of the others; or
/// draws `samples` and `flat_samples` of them.
void ChoosePixels(const TagRegion& region, const BlurredPattern& pattern, const LensMap& lens,
                  const Image& image, FacePixels& pixels);

}  // namespace flextip
