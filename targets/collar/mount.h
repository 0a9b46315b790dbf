// The mount of a tag collar as a closed surface, and as an STL file for a printer.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <filesystem>
#include <vector>

#include "targets/collar/design.h"

namespace flextip {

/// Triangles by their corners, anticlockwise as seen from outside.
struct MountSurface {
  std::vector<Eigen::Vector3d> corners_m;
  std::vector<std::array<int, 3>> triangles;

  /// Returns six times the mean of the corners' signed volumes: positive where normals point out.
  double Volume_m3() const;
};

/// Returns the prism with a round bore, x along the shaft, its middle at the origin; face i at
/// angle 2 pi i / faces from y toward z. The bore has 96 flats or so and is nowhere narrower than
/// the design's.
MountSurface MountMesh(const CollarDesign& design);

/// Writes a binary STL file in mm. Throws WorkError where the disk refuses.
void WriteStl(const std::filesystem::path& file, const MountSurface& mesh);

}  // namespace flextip
