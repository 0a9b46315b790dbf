// EM calibration: where the EM system stands in R, where its sensor sits on the shaft, and how
// metal distorts its field.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/em/choice.h"
#include "calibration/em/lag.h"
#include "recording/calibrations/file.h"

namespace flextip {

struct EmOptions {
  double distance_from_tip_m = 0.0;   ///< as the recording says; kept where it cannot be found
  double max_distance_sd_m = 0.001;   ///< a distance less certain than this is not named
  double max_rotation_sd_rad = 0.02;  ///< nor a registration whose rotation is
  double max_field_sd_m = 0.001;      ///< nor a field whose correction is, anywhere it was sensed
};

enum class EmStatus : std::uint8_t {
  kOk,
  kTooFewPairs,
  kUnobservable,  ///< not even the registration is known
  kNoAgreement,   ///< fewer than 60 % of the pairs fit one registration
};
const char* Name(EmStatus status);

struct EmResidual {
  Eigen::Vector3d before_R = Eigen::Vector3d::Zero();  ///< registration alone (m), in R
  Eigen::Vector3d after_R = Eigen::Vector3d::Zero();   ///< with the field chosen
  Eigen::Vector3d place_R = Eigen::Vector3d::Zero();   ///< of the sensor, corrected
  double sigmas = 0.0;
  double angle_rad = 0.0;  ///< sensor's x axis to the shaft, the mean tilt taken out
  bool used = true;
  std::string reason;
};

struct EmResult {
  EmStatus status = EmStatus::kTooFewPairs;
  std::string message;  ///< why not kOk
  EmSolution solution;  ///< covariance with the noise found
  EmDesign design;
  std::vector<EmCandidate> candidates;
  std::vector<Calibration::Unobservable> unobservable;
  double noise_scale = 1.0;       ///< found over stated
  double correlation_time = 1.0;  ///< in pairs; `covariance` counts so many as one
  std::vector<EmResidual> residuals;
  int used = 0;
  double rms_before_m = 0.0, rms_after_m = 0.0;  ///< per component, of those used
  double tilt_rad = 0.0;                         ///< of the sensor's x axis against the shaft
  double angle_rms_rad = 0.0;
  EmLag lag;  ///< of the sensor behind the reference; not taken out

  bool IsUsable() const { return status == EmStatus::kOk; }
};

EmResult CalibrateEm(const std::vector<EmPair>& pairs, const EmOptions& options);

}  // namespace flextip
