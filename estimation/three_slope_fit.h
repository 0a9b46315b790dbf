// The thesis's beam from the shaft's directions at wrist, port and tip: three slopes for two
// parameters, by nonlinear least squares on (3.2), as in 4.2. Allocates nothing.
#pragma once

#include <Eigen/Dense>

#include "estimation/slope_fit.h"
#include "kinematics/beam.h"

namespace flextip {

struct ThreeSlopeFit {
  BeamFit beam;
  double gamma_rad = 0.0;  ///< (5.23): measured less modelled angle at the wrist
  double chi2 = 0.0;       ///< of the three slopes at the solution, one degree of freedom
  int iterations = 0;
};

/// As FitFromSlopes, with the direction at the port. Slopes are weighted by their noise (where none
/// is stated, all alike), the chord's noise being common to all three.
ThreeSlopeFit FitFromThreeSlopes(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                                 const Eigen::Vector3d& t_wrist, const Eigen::Vector3d& t_port,
                                 const Eigen::Vector3d& t_tip, double length_m,
                                 const SlopeNoise& noise,
                                 double significance = kBendSignificance) noexcept;

}  // namespace flextip
