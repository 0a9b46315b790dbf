#include "apps/calibration_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "core/error.h"

namespace flextip {

void AddCalibrationOption(CLI::App& command, CalibrationFiles& files) {
  command
      .add_option(
          "--calibration", files,
          "Take this calibration.yaml (of flextip calibrate) in place of what the recording "
          "says; once for each")
      ->type_name("FILE");
}

std::vector<UsedCalibration> UseCalibrations(const CalibrationFiles& files, Recording& recording,
                                             std::vector<std::string>& warnings) {
  std::vector<UsedCalibration> used;
  for (const auto& file : files) {
    UsedCalibration one{file, ReadCalibration(file), {}};
    AppliedCalibration applied = ApplyCalibration(file, one.calibration, recording);
    if (!applied.em_field.empty()) {
      throw InputError::At(file.string(), 0, applied.em_field[0] + ": not supported yet");
    }
    one.names = std::move(applied.used);
    if (one.names.empty()) {
      warnings.push_back(fmt::format("{}: nothing in it is part of a recording", file.string()));
    }
    warnings.insert(warnings.end(), applied.warnings.begin(), applied.warnings.end());
    used.push_back(std::move(one));
  }
  return used;
}

nlohmann::json CalibrationsJson(const std::vector<UsedCalibration>& used) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& one : used) {
    list.push_back(
        {{"file", one.file.string()}, {"kind", one.calibration.kind}, {"names", one.names}});
  }
  return list;
}

std::vector<std::string> NotTrackedWith(const std::filesystem::path& tracked,
                                        const std::vector<UsedCalibration>& used) {
  std::set<std::string> known;
  std::ifstream file(tracked / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  if (summary.is_object() && summary.contains("calibrations")) {
    for (const auto& one : summary["calibrations"]) {
      for (const auto& name : one["names"]) known.insert(name.get<std::string>());
    }
  }
  std::vector<std::string> missing;
  for (const auto& one : used) {
    for (const std::string& name : one.names) {
      const bool matters = name.starts_with("cam") || name.starts_with("tags0.");
      if (matters && !known.contains(name)) missing.push_back(name);
    }
  }
  return missing;
}

}  // namespace flextip
