// The rod's equations integrated from the tip towards the wrist by Taylor series. Private to
// kinematics: the rod's solver is the only user.
//
// Units: length L, force EI/L^2, moment EI/L. With sigma the arc length from the tip,
//   dt/dsigma = t x m,  dy/dsigma = y x m,  dm/dsigma = t x n,  dP/dsigma = t,
//   n(sigma) = n0 + q sigma:
// polynomial, so the Taylor coefficients of any order follow from short recurrences (no table of
// magic coefficients, and the step length follows from the last coefficients themselves).
#pragma once

#include <Eigen/Dense>

#include "kinematics/rod/point.h"
#include "kinematics/rod/variation.h"

namespace flextip {

/// The internal force along one stretch: n(u) = n0 + q u.
struct RodForce {
  Eigen::Vector3d n0 = Eigen::Vector3d::Zero();
  Eigen::Vector3d q = Eigen::Vector3d::Zero();
};

/// Carries `point` over `length`. `map`, where not null, goes on by the map of variations over the
/// stretch. Returns false where that takes more than a bounded number of steps (a load far beyond
/// buckling).
bool Advance(double length, RodForce force, RodPoint& point, RodMap* map);

}  // namespace flextip
