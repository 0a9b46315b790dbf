// A shaft's bending stiffness, and how it changes along the shaft, from known loads on the tip.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/shaft/known_loads.h"
#include "recording/calibrations/file.h"

namespace flextip {

enum class StiffnessStatus : std::uint8_t {
  kOk,
  kModelIncomplete,  ///< found, but no stiffness explains the shapes to their noise
  kUnobservable,     ///< the loads say too little of it
};
const char* Name(StiffnessStatus status);

/// One of the two models: constant, and with a taper.
struct StiffnessModel {
  bool converged = false;
  double stiffness_Nm2 = 0.0, taper = 0.0;
  double stiffness_sd_Nm2 = 0.0, taper_sd = 0.0;
  double chi2_per_dof = 0.0;
  double tip_rms_m = 0.0;          ///< place measured less predicted, all three axes
  double heldout_tip_rms_m = 0.0;  ///< each eighth of the recording, by a fit to the others
  double heldout_chi2 = 0.0;       ///< per measurement
};

struct StiffnessHoldResult {
  LoadHold hold;
  double s_port_m = 0.0;
  Eigen::Vector3d place_residual_m = Eigen::Vector3d::Zero();  ///< of tip or EM sensor
  double chi2 = 0.0;
  int measurements = 0;
  bool used = false;
  std::string reason;  ///< why not
};

/// Residuals at like insertions.
struct InsertionResidual {
  double inserted_m = 0.0;  ///< beyond the port, mean
  int holds = 0;
  double tip_rms_m = 0.0;
  double along_load_m_N = 0.0;  ///< residual along the load per newton: compliance not modelled
};

struct StiffnessCalibration {
  StiffnessStatus status = StiffnessStatus::kUnobservable;
  std::optional<StiffnessModel> constant, tapered;  ///< those that were asked for
  bool taper_chosen = false;
  const StiffnessModel& chosen() const { return taper_chosen ? *tapered : *constant; }
  double bend_m = 0.0;  ///< how far the loads bend the tip away at most
  Eigen::Vector3d port_shift_m = Eigen::Vector3d::Zero();  ///< from where it is registered
  double port_noise_m = 0.0;                               ///< as it was taken to be
  std::vector<StiffnessHoldResult> holds;                  ///< of the model chosen
  std::vector<InsertionResidual> by_insertion;
  Calibration found;
  std::string advice;
};

enum class StiffnessChoice : std::uint8_t { kByHeldoutError, kConstant, kTaper };

struct StiffnessCalibrationOptions {
  StiffnessChoice choice = StiffnessChoice::kByHeldoutError;
  double port_noise_m = 3e-4;
  std::size_t most_holds = 400;
};

/// Calibrates from load0, wrist0, and vision0 or em0 (also strain0, in Nm). Throws InputError, with
/// `source` in the message, where a stream is missing or fewer than five holds can be used.
StiffnessCalibration CalibrateStiffness(const Recording& recording, const std::string& source,
                                        const StiffnessCalibrationOptions& options = {});

}  // namespace flextip
