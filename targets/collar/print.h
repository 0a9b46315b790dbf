// The strip of tags of a collar, to print to scale and wrap around the mount.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "targets/collar/design.h"
#include "targets/print/sheet.h"

namespace flextip {

/// Returns the black parts of the strip (m): x to the right toward the tip, y down along the faces
/// in the order of their tags; the origin is the strip's upper left corner. The tags stand as they
/// are read, in the middle of their faces.
std::vector<Eigen::AlignedBox2d> StripFace(const CollarDesign& design);

/// Draws the strip several times with cutting lines, marks where it folds, a flap to glue, rulers
/// and what to do. Throws InputError where no strip fits on the paper, WorkError where the disk
/// refuses.
void PrintCollar(const CollarDesign& design, const Paper& paper, const std::filesystem::path& file);

}  // namespace flextip
