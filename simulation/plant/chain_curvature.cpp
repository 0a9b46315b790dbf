#include "simulation/plant/chain_curvature.h"

#include <cmath>

#include "core/rotation.h"

namespace flextip::simulation {

Eigen::Vector3d WristTangent(const std::vector<Eigen::Vector3d>& u) {
  // The cubic through four equidistant values, half a step before the first.
  return (2.1875 * u[0] - 2.1875 * u[1] + 1.3125 * u[2] - 0.3125 * u[3]).normalized();
}

Eigen::Matrix3d WristAxes(const Eigen::Vector3d& t_wrist, double roll_rad) {
  return RotationWithoutTwist(Eigen::Vector3d::UnitX(), t_wrist) *
         ExpRotation(roll_rad * Eigen::Vector3d::UnitX());
}

namespace {

/// `b`, normal to the unit vector u, turned about it.
Eigen::Vector3d Twisted(const Eigen::Vector3d& b, const Eigen::Vector3d& u, double angle) {
  return std::cos(angle) * b + std::sin(angle) * u.cross(b);
}

}  // namespace

void UpdateRest(const ChainProblem& problem, const ChainState& state, ChainRest& rest) {
  if (!problem.IsCurved()) return;
  const int joints = problem.Links() - 1;
  const ChainGeometry geometry(problem, state.s);
  rest.curvature.resize(joints);
  rest.torque.resize(joints, 0.0);
  rest.twist.resize(joints, 0.0);
  const Eigen::Vector3d t_wrist = WristTangent(state.u);
  const Eigen::Vector3d at_wrist =
      WristAxes(t_wrist, problem.roll_rad).rightCols<2>() * problem.curvature;
  Eigen::Vector3d b = Twisted(Carried(at_wrist, t_wrist, state.u[0]), state.u[0], rest.wrist_twist);
  for (int i = 0; i < joints; ++i) {
    rest.curvature[i] = Twisted(b, state.u[i], 0.5 * rest.twist[i]);
    b = Carried(Twisted(b, state.u[i], rest.twist[i]), state.u[i], state.u[i + 1]);
  }
  double torque = 0.0;
  for (int i = joints - 1; i >= 0; --i) {
    rest.torque[i] = torque;
    torque -= geometry.Joint(i).curve * rest.curvature[i].dot(state.u[i + 1]);
  }
  rest.wrist_torque = torque;
  rest.wrist_twist = -torque * 0.5 * geometry.h(0) / problem.torsion / geometry.Stiffness(0);
  for (int i = 0; i < joints; ++i) {
    rest.twist[i] =
        -rest.Middle(i) * geometry.JointLength(i) / problem.torsion / geometry.Stiffness(i);
  }
}

Eigen::Vector3d JointMoment(const ChainGeometry& geometry, const ChainState& state,
                            const ChainRest& rest, int link) {
  const ChainJoint joint = geometry.Joint(link);
  const Eigen::Vector3d &u = state.u[link], &v = state.u[link + 1];
  Eigen::Vector3d moment = joint.bend * u.cross(v);
  if (!rest.curvature.empty()) {
    const Eigen::Vector3d& b = rest.curvature[link];
    moment -= joint.curve * (u.dot(v) * b - b.dot(v) * u);
    moment -= rest.torque[link] / (1.0 + u.dot(v)) * (u + v);
  }
  return moment;
}

}  // namespace flextip::simulation
