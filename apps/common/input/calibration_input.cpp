#include "apps/common/input/calibration_input.h"

#include <set>

#include "core/error.h"
#include "recording/text/text.h"

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
  const auto file = tracked / "summary.json";
  if (std::filesystem::exists(file)) {
    const auto summary = nlohmann::json::parse(ReadTextFile(file), nullptr, false);
    try {
      for (const auto& one : summary.value("calibrations", nlohmann::json::array())) {
        for (const auto& name : one.at("names")) known.insert(name.get<std::string>());
      }
    } catch (const nlohmann::json::exception&) {
      throw InputError::At(file.string(), 0, "is damaged, expected the summary of flextip track");
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
