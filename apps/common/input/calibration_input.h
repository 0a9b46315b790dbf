// Results of flextip calibrate, given to another command with --calibration.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recording/calibrations/apply.h"

namespace flextip {

using CalibrationFiles = std::vector<std::filesystem::path>;

/// Adds --calibration. `files` must outlive the parsing.
void AddCalibrationOption(CLI::App& command, CalibrationFiles& files);

/// Returns the summary's list of calibrations: `file`, `kind`, `names`.
nlohmann::json CalibrationsJson(const std::vector<UsedCalibration>& used);

/// Returns the names in `used` that tips depend on and that the run of flextip track in the folder
/// `tracked` was not given, by its summary.json.
std::vector<std::string> NotTrackedWith(const std::filesystem::path& tracked,
                                        const std::vector<UsedCalibration>& used);

}  // namespace flextip
