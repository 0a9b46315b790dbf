// The unloaded curvature of a chain: its axes are the wrist's, carried along without twist, so they
// depend on the whole shape before them.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "simulation/plant/chain_geometry.h"

namespace flextip::simulation {

/// Returns the wrist's tangent: the links' directions, which hold at their middles, continued to
/// the end.
Eigen::Vector3d WristTangent(const std::vector<Eigen::Vector3d>& u);

/// Returns the instrument's axes at the wrist, x along the shaft: R's turned without twist, after
/// the roll.
Eigen::Matrix3d WristAxes(const Eigen::Vector3d& t_wrist, double roll_rad);

/// Returns `b`, normal to u, taken to v without twist.
inline Eigen::Vector3d Carried(const Eigen::Vector3d& b, const Eigen::Vector3d& u,
                               const Eigen::Vector3d& v) {
  return b - b.dot(v) / (1.0 + u.dot(v)) * (u + v);
}

/// Of each joint the unloaded curvature vector B and the torsion. With W the energy and psi_i the
/// twist of link i's frame, dW/dpsi at joint i is T_i = -curve_i B_i.u_i+1, half of it by the twist
/// of either link, and turning links i and i+1 twists all frames beyond by
///   -(u_i x u_i+1).(du_i + du_i+1) / (1 + u_i.u_i+1).
/// The joint's torsion moment is minus the sum of the T beyond it; it twists the joint by itself
/// over the torsional stiffness, times the joint's length. Empty where there is no unloaded
/// curvature.
struct ChainRest {
  std::vector<Eigen::Vector3d> curvature;
  std::vector<double> torque;  ///< sum of T over the joints beyond
  std::vector<double> twist;   ///< of the joint's two links against each other (rad)
  double wrist_torque = 0.0;   ///< sum of all T
  double wrist_twist = 0.0;    ///< between the wrist and the first link's middle
  /// Returns the sum of T beyond the joint and half its own.
  double Middle(int joint) const {
    const double before = joint > 0 ? torque[joint - 1] : wrist_torque;
    return 0.5 * (torque[joint] + before);
  }
};

/// Updates axes and torsion, which depend on each other: takes the torsion of the last call from
/// `rest`, so that it converges along with the chain's iterations.
void UpdateRest(const ChainProblem& problem, const ChainState& state, ChainRest& rest);

/// Returns the moment (Nm) in the joint behind `link` of the part beyond on the part before.
Eigen::Vector3d JointMoment(const ChainGeometry& geometry, const ChainState& state,
                            const ChainRest& rest, int link);

}  // namespace flextip::simulation
