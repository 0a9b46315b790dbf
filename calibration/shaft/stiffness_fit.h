// Bending stiffness and taper fitted to shapes under known loads. Private to calibration.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "calibration/shaft/known_loads.h"
#include "calibration/shaft/stiffness_rod.h"
#include "core/linear_algebra.h"
#include "core/matrix_types.h"

namespace flextip {

/// The unknowns: logarithm of the stiffness, taper, the port's place, then turn and shift of the
/// frames of vision0 and of em0 in R, about the middle of what they saw.
inline constexpr int kLogStiffness = 0, kStiffnessTaper = 1, kStiffnessPort = 2, kVisionTurn = 5,
                     kVisionShift = 8, kEmTurn = 11, kEmShift = 14, kStiffnessUnknowns = 17;
/// Of kStiffnessUnknowns.
using StiffnessVector = Eigen::VectorXd;
using StiffnessMatrix = Eigen::MatrixXd;

/// What is fixed, and how well the rest is known beforehand.
struct StiffnessSetup {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  double stations_m[2] = {0.0, 0.0};  ///< of strain0
  double moment_noise_Nm = 0.0;       ///< 0: strain0 is not used
  double em_from_tip_m = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of what vision0 and em0 saw
  /// Standard deviations; 0: not an unknown.
  double taper_prior = 0.0, port_noise_m = 3e-4;
  double vision_turn_rad = 0.0, vision_shift_m = 0.0, em_turn_rad = 0.0, em_shift_m = 0.0;
};

/// One hold's measurements less what the rod says, with the errors of load and wrist in their
/// covariance, and how they depend on the unknowns. The first rows are the tip's (or, without
/// vision0, the EM sensor's) place in m.
struct StiffnessRows {
  bool usable = false;
  double s_port_m = 0.0;
  Eigen::VectorXd residual;
  Eigen::MatrixXd covariance, by_unknowns;
  bool has_place = false;

  double Chi2() const { return MahalanobisSquared(residual, covariance); }
};

struct StiffnessFit {
  bool converged = false;
  StiffnessVector x = StiffnessVector::Zero(kStiffnessUnknowns);
  StiffnessMatrix covariance, information;  ///< empty before the fit
  std::vector<StiffnessRows> rows;          ///< of each hold, at `x`

  auto Usable() const {
    return std::count_if(rows.begin(), rows.end(), [](const auto& r) { return r.usable; });
  }
};

/// The most likely unknowns, with every hold's true load and wrist as unknowns of its own (errors
/// in both), by Gauss-Newton; `weights` one a hold.
class StiffnessFitter {
 public:
  StiffnessFitter(const StiffnessSetup& setup, const std::vector<LoadHold>& holds);

  StiffnessFit Fit(const std::vector<double>& weights, const StiffnessVector& start);
  /// As the recording says.
  StiffnessVector Nominal() const;

  /// What another hold would add; its measurements are taken as predicted.
  StiffnessRows RowsOf(const LoadHold& hold, const StiffnessVector& x);

 private:
  struct Hidden {  // true less stated load, true less measured wrist
    Vector6d d = Vector6d::Zero();
    Eigen::MatrixXd gain;  // of d by the residual
  };
  StiffnessRows Rows(const LoadHold& hold, const StiffnessVector& x, TaperedRodSolver& solver,
                     Hidden& hidden) const;
  StiffnessVector PriorInformation() const;
  double Evaluate(const StiffnessVector& x, const std::vector<double>& weights, StiffnessMatrix& N,
                  StiffnessVector& gradient, StiffnessFit& fit);

  StiffnessSetup setup_;
  const std::vector<LoadHold>& holds_;
  std::vector<Hidden> hidden_;
  std::vector<TaperedRodSolver> solvers_;  // each starts from its hold's last equilibrium
};

}  // namespace flextip
