// Reads and writes arm.yaml; reads a URDF.
#pragma once

#include <filesystem>

#include "recording/arm/arm.h"
#include "recording/read_log.h"

namespace flextip {

/// Reads arm.yaml or, by its ending, a .urdf. Throws InputError with file and line for an unknown
/// format, version, convention or joint type, keys that are missing, links of another number than
/// joints, a place on a link that is not there.
Arm ReadArm(const std::filesystem::path& file, ReadLog& log);

/// Writes arm.yaml. Throws WorkError for an arm from a URDF, which has no such numbers.
void WriteArm(const std::filesystem::path& file, const Arm& arm);

/// Reads the movable joints of a URDF from the root to `tip` (empty: the longest chain), fixed
/// joints taken into their neighbours, with the links' masses where all of them have one.
Arm ReadUrdf(const std::filesystem::path& file, const std::string& tip, ReadLog& log);

}  // namespace flextip
