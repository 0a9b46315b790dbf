// Registration and field fitted to pairs of sensor and reference.
#pragma once

#include <vector>

#include "calibration/em/pairs.h"
#include "recording/calibrations/em_field.h"

namespace flextip {

/// The free parameters beside the registration: the sensor's distance from the tip, a field over a
/// box. To stay separate from the registration, the field neither shifts nor turns its box: a
/// polynomial has no constant and a symmetric linear part, a spline's coefficients no mean and no
/// mean turn about its middle.
struct EmDesign {
  bool free_distance = true;
  FieldBasis basis = {};
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero(), scale_m = Eigen::Vector3d::Ones();
  double bend_sd_m = 0.0;  ///< of a spline's second differences, which are held to zero; 0: free

  int Coefficients() const { return 3 * basis.Count(); }
  int Parameters() const { return 6 + (free_distance ? 1 : 0) + Coefficients(); }
};

struct EmSolution {
  bool ok = false;  ///< false: the pairs leave something of the design unknown
  Pose T_RF = {};
  double distance_m = 0.0;
  FieldCorrection field = {};
  /// Of (dw, dp) of T_RF, the distance where it is free, the coefficients; as the stated noise has
  /// it.
  Eigen::MatrixXd covariance = {};
};

/// Returns the corrected sensor less the reference (m), in R.
Eigen::Vector3d EmError(const EmPair& pair, const EmSolution& solution);
/// Returns the error's length in stated standard deviations.
double EmSigmas(const EmPair& pair, const EmSolution& solution);

/// Whitened errors at a solution and their derivative by the design's parameters, three rows a pair
/// (the field's own slope, some per cent, left out of the derivative).
struct EmRows {
  Eigen::MatrixXd J;
  Eigen::VectorXd r;
};
EmRows RowsOf(const std::vector<EmPair>& pairs, const EmDesign& design, const EmSolution& solution);

/// The step that Gauss and Newton take where the rows' weighted squares are H and g, with the gauge
/// and a spline's bend held; and the covariance. `ok` false: something is left unknown.
struct EmStep {
  bool ok = false;
  Eigen::VectorXd step;
  Eigen::MatrixXd covariance;  ///< only where asked for
};
EmStep SolveStep(const EmDesign& design, const Eigen::MatrixXd& H, const Eigen::VectorXd& g,
                 const Eigen::VectorXd& coefficients, bool with_covariance);

/// Fits by least squares with `weights` from `start`, whose distance is kept where the distance is
/// not free.
EmSolution FitEm(const std::vector<EmPair>& pairs, const std::vector<double>& weights,
                 const EmDesign& design, const EmSolution& start);

/// Fits the registration in closed form (Arun 1987) with the sensor `distance_m` behind the tip,
/// then by least absolute residuals with the distance free.
EmSolution RobustEm(const std::vector<EmPair>& pairs, double distance_m);

}  // namespace flextip
