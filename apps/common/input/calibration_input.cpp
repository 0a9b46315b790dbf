#include "apps/common/input/calibration_input.h"

#include <fstream>
#include <set>

namespace flextip {

void AddCalibrationOption(CLI::App& command, CalibrationFiles& files) {
  command
      .add_option(
          "--calibration", files,
          "Take this calibration.yaml (of flextip calibrate) in place of what the recording "
          "says; once for each")
      ->allow_extra_args(false)
      ->type_name("FILE");
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
