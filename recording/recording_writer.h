// Writes recordings so that reading them again gives the same numbers to the last bit.
#pragma once

#include <filesystem>

#include "recording/recording.h"

namespace flextip {

/// Writes every stream present below `folder`, which must exist. Frames of cam0 are not written
/// here: whoever makes them puts them under cam0/data/. Throws WorkError where the disk refuses.
void WriteRecording(const std::filesystem::path& folder, const Recording& recording);

}  // namespace flextip
