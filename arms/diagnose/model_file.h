// model.yaml of an arm (docs/formats.md): the effects that were found, all others as far as the
// data moved them, and what no file states, for the base and for the extended model.
#pragma once

#include <filesystem>
#include <string>

#include "arms/diagnose/diagnose.h"

namespace flextip::arms {

inline constexpr const char* kArmModelFormat = "flextip-arm-model";

std::string ArmModelYaml(const ArmModel& model);

/// Whether the file says that it is an arm's.
bool IsArmModel(const std::filesystem::path& file);

/// Throws InputError with file and line for an unknown format or version, effects that are unknown,
/// values that are no numbers.
ArmModel ReadArmModel(const std::filesystem::path& file);

}  // namespace flextip::arms
