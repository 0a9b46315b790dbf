// Recordings that calibrations are applied to.
#pragma once

#include "core/error.h"
#include "core/rotation.h"
#include "recording/calibrations/apply.h"
#include "sample_recording.h"

namespace flextip::test_support {

inline AppliedCalibration Apply(const Calibration& c, Recording& recording) {
  return ApplyCalibration("found.yaml", c, recording);
}
inline Calibration WithNumbers(const std::string& name, const std::vector<double>& values) {
  Calibration c;
  c.numbers[name] = values;
  return c;
}
inline std::string ErrorOf(const Calibration& c, Recording recording) {
  try {
    Apply(c, recording);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
inline const Pose kPose{ExpRotation({0.3, -1.2, 0.4}), {0.1, -0.05, 0.2}};

/// A recording with numbers of a size that survives arithmetic.
inline Recording Plain() {
  Recording r = MakeRecording();
  r.instrument.length_m = 0.6;
  r.cam0->calibration.T_RC = {ExpRotation({0.1, 0.2, -0.3}), {0.3, 0.1, -0.2}};
  r.cam1->calibration.T_RC = {ExpRotation({0.1, 0.2, -0.3}), {0.31, 0.1, -0.2}};
  r.vision0->camera = "cam0";
  int i = 0;
  for (auto& sample : r.vision0->tips) {
    const double x = 0.01 * ++i;
    sample.value = {TipStatus::kOk,
                    {0.2 + x, x * x, -x},
                    Eigen::Vector3d(1, 4, 9).asDiagonal(),
                    Eigen::Vector3d::UnitX()};
  }
  i = 0;
  for (auto& sample : r.em0->samples) {
    const double x = 0.01 * ++i;
    sample.value = {{0.1 + x, x, -x}, Eigen::Quaterniond(ExpRotation({x, 0.2, 0.1}))};
  }
  i = 0;
  for (auto& sample : r.strain0->moments_Nm) {
    ++i;
    sample.value << i, 2 + i, 3 - i, i * i;
  }
  return r;
}

}  // namespace flextip::test_support
