// A model of the shaft's stiffness, fitted and judged. Private to calibration.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/shaft/known_loads.h"
#include "calibration/shaft/stiffness_calibration.h"
#include "calibration/shaft/stiffness_fit.h"

namespace flextip {

/// One model, fitted without outliers, and how it does on what it was not fitted to.
class StiffnessModelFit {
 public:
  /// With a taper where `setup` has a prior of it.
  StiffnessModelFit(const StiffnessSetup& setup, const std::vector<LoadHold>& holds);

  const StiffnessFit& fit() const { return fit_; }
  const StiffnessModel& model() const { return model_; }
  const std::vector<double>& weights() const { return weights_; }
  const StiffnessMatrix& covariance() const { return covariance_; }
  StiffnessFitter& fitter() { return fitter_; }
  /// Whether the holds scatter by more than their noise.
  bool IsIncomplete() const;

 private:
  void RejectOutliers();
  void Score();
  void HoldOut();

  StiffnessFitter fitter_;
  std::vector<double> weights_;
  bool taper_;
  StiffnessFit fit_;
  StiffnessModel model_;
  StiffnessMatrix covariance_;
  double freedoms_ = 1.0;
};

/// Returns which load tells most next, in words; empty where none tells much. `chosen`: the model
/// of `result`. `for_taper`: about the taper, not the stiffness.
std::string AdviseLoad(StiffnessModelFit& chosen, bool for_taper, const Eigen::Vector3d& p_RP,
                       const StiffnessCalibration& result);

}  // namespace flextip
