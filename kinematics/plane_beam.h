// The thesis's beam in its plane: shape (3.1), (3.2), (3.10), the forward solution (3.28), (3.7),
// (3.6), and d tip / d wrist by a chain rule that finite differences confirm. The thesis's own
// (3.16)-(3.23) and (5.30)-(5.34) are wrong except at a = L/2 (docs/errata.md).
//
// Model frame M: wrist at the origin, x along the chord to the tip. F below is F_p / EI (1/m^2),
// acting on the shaft along -y_M where positive, as in (3.1).
#pragma once

#include <Eigen/Dense>

#include "kinematics/beam.h"

namespace flextip {

/// Returns the height of the beam at `x` (m), (3.1).
double BeamHeight(double F, double a, double length, double x) noexcept;
/// Returns the slope dy/dx of the beam at `x`, (3.2).
double BeamSlope(double F, double a, double length, double x) noexcept;
/// Returns the height of the beam at the port (m), (3.10).
double BeamPortHeight(double F, double a, double length) noexcept;
/// Returns d y_m(a) / d a while the port slides along the shaft under the load law.
double BeamPortHeightRate(double F, double a, double length, BeamLoadLaw law) noexcept;

struct PlaneBeamProblem {
  Eigen::Vector2d p_wrist = Eigen::Vector2d::Zero();
  Eigen::Vector2d p_port = Eigen::Vector2d::Zero();
  double length_m = 0.0;
  BeamLoadLaw law = BeamLoadLaw::kTipForce;
  double load_over_EI = 0.0;  ///< F_t/EI or F_p/EI (1/m^2), after `law`; signed as F_p in (3.1)
};

struct PlaneBeam {
  BeamStatus status = BeamStatus::kBadInput;
  double F_p_over_EI = 0.0;
  double a = 0.0;    ///< port along the chord (m)
  double phi = 0.0;  ///< from the world's x axis to the chord (rad)
  Eigen::Vector2d p_tip = Eigen::Vector2d::Zero();
  Eigen::Matrix2d J_tip_wrist = Eigen::Matrix2d::Zero();  ///< the load of `law` held constant
  Eigen::Matrix2d J_tip_port = Eigen::Matrix2d::Zero();

  bool IsUsable() const { return status == BeamStatus::kOk; }
};

/// Solves the beam through a given wrist and port, bent by a given load. Of several solutions
/// (loads with F_t L^2/EI > 12, where no beam applies), takes the solution nearest the straight
/// shaft. The status is kNoPort where the shaft does not reach the port, or the wrist is on it.
PlaneBeam SolvePlaneBeam(const PlaneBeamProblem& problem) noexcept;

/// Returns d tip / d wrist (2x2) of a beam with its chord at the angle `phi` (rad), 0 < a < length.
Eigen::Matrix2d PlaneBeamJacobian(double F, double a, double length, double phi,
                                  BeamLoadLaw law) noexcept;

}  // namespace flextip
