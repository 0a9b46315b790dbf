// Which name of a calibration file changes what.
#include "recording/calibrations/apply.h"

#include <fmt/format.h>

#include <utility>

#include "recording/calibrations/calibration_use.h"

namespace flextip {

const std::vector<double>& CalibrationUse::Numbers(const std::string& name,
                                                   std::size_t count) const {
  const auto& values = found_.numbers.at(name);
  if (values.size() != count) {
    Refuse(name, fmt::format("found {} numbers, expected {}", values.size(), count));
  }
  return values;
}

double CalibrationUse::Positive(const std::string& name) const {
  const double value = Numbers(name, 1)[0];
  if (!(value > 0)) Refuse(name, fmt::format("found {}, expected more than 0", value));
  return value;
}

void CalibrationUse::ApplyPose(const std::string& name, const Pose& pose) {
  if (name.starts_with("board.") || name == "tags0.T_WE") {
    applied_.not_used.push_back(name);
    return;
  }
  if (name == "cam0.T_RC" || name == "cam1.T_RC") {
    PlaceCameras(name, pose);
  } else if (name == "cam1.T_C0C1") {
    PlaceSecondCamera(pose);
  } else if (name == "em0.T_RF") {
    RegisterEm(pose);
  } else if (name.ends_with(".T_WC")) {
    Refuse(name,
           "the camera moves with the wrist, and only cameras that stand still are supported");
  } else {
    Refuse(name, "unknown name");
  }
  applied_.used.push_back(name);
}

void CalibrationUse::ApplyNumbers(const std::string& name) {
  const std::string eye =
      name.starts_with("cam0.") || name.starts_with("cam1.") ? name.substr(5) : "";
  if (name == "pivot.p_R" || name == "tip.p_SE") {
    applied_.not_used.push_back(name);
    return;
  }
  if (name == "em0.field" || name == "em0.field_centre_m" || name == "em0.field_scale_m") {
    Need(recording_.em0, name);
    field_names_.push_back(name);
    return;
  }
  const std::string quantity = name.substr(name.find('.') + 1);
  if (quantity == "time_rate" || quantity == "time_origin_s") {
    CheckClock(name);  // STREAM.time_offset_s takes it
  } else if (eye == "intrinsics") {
    SetIntrinsics(name);
  } else if (eye == "distortion_coefficients") {
    SetDistortion(name);
  } else if (quantity == "time_offset_s") {
    SetClock(name);
  } else if (name == "tip.p_WE") {
    MoveTip();
  } else if (name == "tags0.p_E") {
    MoveTipOnCollar();
  } else if (name == "em0.distance_from_tip_m") {
    SetEmDistance();
  } else if (name == "strain0.gage_matrix") {
    SetGages();
  } else if (name == "strain0.offset_Nm" || name == "strain0.moment_noise_Nm") {
    if (!Finds("strain0.gage_matrix")) SetGages();  // which says what is missing
  } else if (name == "instrument.bending_stiffness_Nm2" || name == "instrument.stiffness_taper") {
    SetStiffness(name);
  } else {
    Refuse(name, "unknown name");
  }
  applied_.used.push_back(name);
}

/// Its coefficients have taken it already.
void CalibrationUse::ApplyText(const std::string& name) {
  const bool is_model = name == "cam0.distortion_model" || name == "cam1.distortion_model";
  if (!is_model) Refuse(name, "unknown name");
  if (!Finds(name.substr(0, 5) + "distortion_coefficients"))
    Refuse(name, "there are no distortion_coefficients with it");
  applied_.used.push_back(name);
}

AppliedCalibration CalibrationUse::Run() {
  for (const auto& [name, pose] : found_.poses) ApplyPose(name, pose);
  for (const auto& entry : found_.numbers) ApplyNumbers(entry.first);
  for (const auto& entry : found_.texts) ApplyText(entry.first);
  if (!field_names_.empty()) CorrectField();
  return std::move(applied_);
}

AppliedCalibration ApplyCalibration(const std::filesystem::path& file,
                                    const Calibration& calibration, Recording& recording) {
  return CalibrationUse(file, calibration, recording).Run();
}

std::vector<UsedCalibration> ApplyCalibrations(const std::vector<std::filesystem::path>& files,
                                               Recording& recording,
                                               std::vector<std::string>& warnings) {
  std::vector<UsedCalibration> used;
  for (const auto& file : files) {
    UsedCalibration one{file, ReadCalibration(file), {}};
    AppliedCalibration applied = ApplyCalibration(file, one.calibration, recording);
    one.names = std::move(applied.used);
    if (one.names.empty()) {
      warnings.push_back(fmt::format("{}: nothing in it is part of a recording", file.string()));
    }
    warnings.insert(warnings.end(), applied.warnings.begin(), applied.warnings.end());
    used.push_back(std::move(one));
  }
  return used;
}

}  // namespace flextip
