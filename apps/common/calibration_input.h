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

/// `files` must outlive the parsing.
void AddCalibrationOption(CLI::App& command, CalibrationFiles& files);

struct UsedCalibration {
  std::filesystem::path file;
  Calibration calibration;
  std::vector<std::string> names;  ///< that changed the recording
};

/// In the order given. Throws InputError.
std::vector<UsedCalibration> UseCalibrations(const CalibrationFiles& files, Recording& recording,
                                             std::vector<std::string>& warnings);

/// As a summary says it: a list of `file`, `kind`, `names`.
nlohmann::json CalibrationsJson(const std::vector<UsedCalibration>& used);

/// Which of the names that tips depend on the run in the folder `tracked` was not given, by its
/// summary.json.
std::vector<std::string> NotTrackedWith(const std::filesystem::path& tracked,
                                        const std::vector<UsedCalibration>& used);

}  // namespace flextip
