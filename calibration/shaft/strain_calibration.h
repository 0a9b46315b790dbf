// Strain gages from known loads: the matrix that makes moments of their readings.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/shaft/strain_fit.h"
#include "calibration/shaft/strain_moments.h"
#include "recording/calibrations/file.h"

namespace flextip {

struct StrainHoldResult {
  LoadHold hold;
  Eigen::Vector4d m_stated_Nm = Eigen::Vector4d::Zero();    ///< by load and rod
  Eigen::Vector4d m_measured_Nm = Eigen::Vector4d::Zero();  ///< by the gages, calibrated
  double s_port_m = 0.0;
  double chi2 = 0.0;  ///< of the four readings
  bool used = false;
  std::string reason;  ///< why it is not used
};

struct StrainCalibration {
  bool gages_known = false, offset_known = false;
  Eigen::Matrix4d gage_matrix = Eigen::Matrix4d::Zero();  ///< Nm per reading; where gages_known
  Eigen::Vector4d offset = Eigen::Vector4d::Zero();       ///< readings
  Eigen::Matrix4d gains = Eigen::Matrix4d::Zero();        ///< readings per Nm
  Eigen::Matrix4d gain_sd = Eigen::Matrix4d::Zero();
  Eigen::Vector4d reading_noise = Eigen::Vector4d::Zero();  ///< of one reading, as measured
  double moment_noise_Nm = 0.0;                             ///< of one reading's moment, RMS
  double chi2_per_dof = 0.0;  ///< of the holds used; the covariance is wider by it where above 1
  double rms_Nm = 0.0, heldout_rms_Nm = 0.0;  ///< moments measured less stated; 0: not known
  double largest_moment_Nm = 0.0;
  std::vector<StrainHoldResult> holds;
  bool insertions_alike = false;  ///< why the gages are not known: `stations_apart` would do
  Calibration found;              ///< for calibration.yaml
  std::string advice;             ///< which further load would help most
};

struct StrainCalibrationOptions {
  GageFitOptions fit;
  std::size_t most_holds = 600;
};

/// Calibrates from strain0 (readings in any unit), load0, wrist0 with orientation, instrument and
/// port. Judges the identifiability of offset and columns by their standard deviations. Throws
/// InputError, with `source` in the message, where a stream is missing or fewer than three holds
/// are usable.
StrainCalibration CalibrateStrain(const Recording& recording, const std::string& source,
                                  const StrainCalibrationOptions& options = {});

/// Returns the most helpful next load and its place, in words; `model` and `fit` as after the
/// calibration. Empty where no load of the recording's size would help.
std::string NextStrainLoad(const std::vector<StrainHoldResult>& holds, const GageFit& fit,
                           const Eigen::Vector4d& reading_sd, const Eigen::Vector3d& p_RP,
                           MomentModel& model);

}  // namespace flextip
