// Results of an item as bytes, for machines that share no files.
#pragma once

#include <filesystem>
#include <string>

namespace flextip {

/// Returns OUT/items/NAME and OUT/logs/NAME.log as bytes, and removes them. A folder that is absent
/// is left out. Throws WorkError where a file cannot be read.
std::string PackItem(const std::filesystem::path& out, const std::string& name);

/// Puts them in their place: beside it first, so that nothing half-written stands there. Throws
/// WorkError where the disk refuses.
void UnpackItem(const std::filesystem::path& out, const std::string& name,
                const std::string& bytes);

}  // namespace flextip
