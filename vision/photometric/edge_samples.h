// Pixels drawn evenly along a tag's edges, where a picture shows more than a fit needs.
#pragma once

#include "vision/photometric/pixel_choice.h"

namespace flextip {

/// Draws pixels within reach of the edges, all along them, and some of the flat ones: about
/// `region.samples` and `region.flat_samples`, none twice. Their number, not the tag's size in the
/// picture, is what this costs. The points follow a low-discrepancy sequence (Roberts, R2).
void SampleEdges(const TagRegion& region, const BlurredPattern& pattern, const LensMap& lens,
                 const Image& image, FacePixels& pixels);

}  // namespace flextip
