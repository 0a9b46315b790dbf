// The collar on its shaft as a drawing with dimensions.
#pragma once

#include <filesystem>

#include "targets/collar/design.h"

namespace flextip {

/// Draws the side view and the view from the tip, to one scale, with dimensions in mm. The ending
/// of `file` chooses PNG, SVG or PDF. Throws WorkError where the disk refuses.
void DrawCollar(const CollarDesign& design, const std::filesystem::path& file);

}  // namespace flextip
