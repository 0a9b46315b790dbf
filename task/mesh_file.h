// Triangle meshes as Wavefront OBJ files.
#pragma once

#include <filesystem>

#include "control/virtual_fixture_mesh.h"

namespace flextip {

/// Reads vertices (`v`, m, in R) and faces (`f`, anticlockwise seen from outside; polygons are cut
/// into triangles). Texture, normals, groups and materials are skipped. Throws InputError with file
/// and line.
TriangleMesh ReadMesh(const std::filesystem::path& file);

}  // namespace flextip
