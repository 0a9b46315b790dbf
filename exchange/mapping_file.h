// A mapping file: how tables became a recording, so that the same import can be made again. The
// recording has its own as import.yaml.
#pragma once

#include <filesystem>
#include <string>

#include "exchange/import_plan.h"

namespace flextip::exchange {

inline constexpr const char* kMappingName = "import.yaml";
inline constexpr int kMappingVersion = 1;

/// Adds what the file says to `plan`, in place of what is there. A recording.yaml is such a file,
/// too: its settings are taken. Relative paths count from the file's folder. Throws InputError with
/// file and line for unknown keys and values of another kind.
void ReadMapping(const std::filesystem::path& file, ImportPlan& plan);

/// The file's text: every number exact.
std::string MappingText(const ImportPlan& plan);

}  // namespace flextip::exchange
