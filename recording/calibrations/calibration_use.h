// One calibration file put into one recording: what apply.cpp reads off the file, and how cameras
// and the other sensors change by it.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "recording/calibrations/apply.h"
#include "recording/calibrations/clock.h"

namespace flextip {

/// Goes through the file's names in their order and changes the recording by each.
class CalibrationUse {
 public:
  CalibrationUse(const std::filesystem::path& file, const Calibration& calibration,
                 Recording& recording)
      : file_(file), found_(calibration), recording_(recording) {}

  AppliedCalibration Run();

 private:
  [[noreturn]] void Refuse(const std::string& name, const std::string& what) const {
    throw InputError::At(file_.string(), 0, fmt::format("{}: {}", name, what));
  }
  template <class Stream>
  Stream& Need(std::optional<Stream>& stream, const std::string& name) const {
    if (!stream)
      Refuse(name, fmt::format("the recording has no {}", name.substr(0, name.find('.'))));
    return *stream;
  }
  const std::vector<double>& Numbers(const std::string& name, std::size_t count) const;
  double Positive(const std::string& name) const;
  bool Finds(const std::string& name) const {
    return found_.poses.contains(name) || found_.numbers.contains(name) ||
           found_.texts.contains(name);
  }

  void ApplyPose(const std::string& name, const Pose& pose);
  void ApplyNumbers(const std::string& name);
  void ApplyText(const std::string& name);
  void PlaceCamera(const std::string& camera, const Pose& T_RC);
  void PlaceCameras(const std::string& name, const Pose& T_RC);
  void PlaceSecondCamera(const Pose& T_C0C1);
  void SetIntrinsics(const std::string& name);
  void SetDistortion(const std::string& name);
  void SetClock(const std::string& name);
  void CheckClock(const std::string& name) const;
  void RetimeTips(const FoundClock& clock);
  void ShiftFrames(const std::string& name, const FoundClock& clock);
  void MoveTip();
  void MoveTipOnCollar();
  void RegisterEm(const Pose& T_RF);
  void SetEmDistance();
  void SetGages();
  void SetStiffness(const std::string& name);
  void CorrectField();

  CameraStream& Camera(const std::string& name) const {
    return Need(name.starts_with("cam0.") ? recording_.cam0 : recording_.cam1, name);
  }
  /// Whether the recording's tips are those that this camera saw.
  bool SeenBy(const std::string& name) const {
    return recording_.vision0 && name.starts_with(recording_.vision0->camera + ".");
  }
  void WarnOfTips(const std::string& name) {
    if (!recording_.vision0) return;
    applied_.warnings.push_back(fmt::format(
        "{}: the tips of vision0 were found without it; run flextip track with it", name));
  }

  const std::filesystem::path& file_;
  const Calibration& found_;
  Recording& recording_;
  AppliedCalibration applied_;
  std::vector<std::string> field_names_;  // `em0.field` and its like
};

/// How far a registered frame may be off, as a turn about `centre_R` and a shift there.
struct RegistrationNoise {
  double turn_rad = 0.0, shift_m = 0.0;
};

/// That of the frame A placed at `T_RA` with the covariance of its entry (empty: none).
RegistrationNoise NoiseAt(const Eigen::MatrixXd& covariance, const Pose& T_RA,
                          const Eigen::Vector3d& centre_R);

}  // namespace flextip
