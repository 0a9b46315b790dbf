#include "apps/common/calibration_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "calibration/em/field.h"
#include "core/error.h"

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

namespace {

Eigen::Vector3d Three(const UsedCalibration& used, const std::string& name) {
  const auto& numbers = used.calibration.numbers;
  const auto found = numbers.find(name);
  if (found == numbers.end() || found->second.size() != 3) {
    throw InputError::At(used.file.string(), 0, name + ": expected three numbers with em0.field");
  }
  return Eigen::Vector3d(found->second.data());
}

/// em0's places without the field's distortion; they are in R already.
void CorrectField(const UsedCalibration& used, Recording& recording,
                  std::vector<std::string>& warnings) {
  const auto& numbers = used.calibration.numbers;
  const auto coefficients = numbers.find("em0.field");
  if (coefficients == numbers.end()) {
    throw InputError::At(used.file.string(), 0, "em0.field: missing beside its centre and scale");
  }
  const FieldCorrection field{coefficients->second, Three(used, "em0.field_centre_m"),
                              Three(used, "em0.field_scale_m")};
  if (!(field.scale_m.minCoeff() > 0)) {
    throw InputError::At(used.file.string(), 0, "em0.field_scale_m: expected more than 0");
  }
  std::size_t outside = 0;
  auto& samples = recording.em0->samples;
  for (auto& sample : samples) {
    outside += !FieldCovers(field, sample.value.p_RS);
    sample.value.p_RS = ApplyField(field, sample.value.p_RS);
  }
  if (outside > 0) {
    warnings.push_back(
        fmt::format("{}: {} of {} samples of em0 lie beyond where em0.field is known",
                    used.file.string(), outside, samples.size()));
  }
}

}  // namespace

std::vector<UsedCalibration> UseCalibrations(const CalibrationFiles& files, Recording& recording,
                                             std::vector<std::string>& warnings) {
  std::vector<UsedCalibration> used;
  for (const auto& file : files) {
    UsedCalibration one{file, ReadCalibration(file), {}};
    AppliedCalibration applied = ApplyCalibration(file, one.calibration, recording);
    one.names = std::move(applied.used);
    if (!applied.em_field.empty()) {
      CorrectField(one, recording, warnings);
      one.names.insert(one.names.end(), applied.em_field.begin(), applied.em_field.end());
    }
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
