// What the chain's port does: it yields and has play, holds the shaft's direction, rubs.
#pragma once

#include <Eigen/Dense>

#include "simulation/plant/chain_geometry.h"
#include "simulation/plant/chain_problem.h"

namespace flextip::simulation {

/// The force of the port across the shaft, given the whole and the tangent.
inline Eigen::Vector3d Lateral(const Eigen::Vector3d& r, const Eigen::Vector3d& t) {
  return r - r.dot(t) * t;
}

/// Where the shaft is held, from where the port's centre is at rest, and the derivative by the
/// port's force r. The hole's centre yields by -compliance y, y the lateral force on the shaft; in
/// the hole the shaft goes by -play y / sqrt(y^2 + play_force^2), to the rim it pushes.
struct PortYield {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the hole
  Eigen::Vector3d shaft = Eigen::Vector3d::Zero();   ///< includes the centre's
  Eigen::Matrix3d dshaft_dr = Eigen::Matrix3d::Zero();
};
PortYield YieldOf(const ChainPort& port, const Eigen::Vector3d& r, const Eigen::Vector3d& t);

/// The torsion spring, energy k/2 angle^2 between the tangent at the port and the rest axis. Its
/// couple makes a corner in the tangent's curve, so the tangent between the two links at the port,
/// v = a u_before + (1 - a) u_behind with a = h_behind / (h_before + h_behind), lags behind by c
/// times the couple, c = h_before h_behind / (2 stiffness (h_before + h_behind)): as a function of
/// v the spring is k / (1 + c k). Without the two the chain would converge with first order only.
struct PortHinge {
  double before = 0.5;                                 ///< a
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< of the energy by v
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  double ds = 0.0;                                   ///< of the energy by s at fixed links
  Eigen::Vector3d couple = Eigen::Vector3d::Zero();  ///< on the shaft
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
  /// Mean of the couple's work per length of sliding: couple . curvature, of both sides.
  double slide = 0.0;
};
PortHinge HingeOf(const ChainProblem& problem, const ChainGeometry& geometry,
                  const ChainState& state);

/// The largest friction force with the port at s.
double FrictionBound(const ChainFriction& friction, double s, double lateral);

/// The force of friction on the shaft along the tangent, and its derivatives by s and by the size
/// of the lateral force: positive when the shaft is drawn out, which makes s grow.
struct FrictionForce {
  double force = 0.0, ds = 0.0, dlateral = 0.0;
};
FrictionForce FrictionOf(const ChainFriction& friction, double s, double lateral);

}  // namespace flextip::simulation
