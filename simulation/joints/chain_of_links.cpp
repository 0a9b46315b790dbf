#include "simulation/joints/chain_of_links.h"

#include <cmath>

namespace flextip::simulation {
namespace {

constexpr double kStep = 1e-5;

Eigen::Matrix4d TurnX(double angle) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T(1, 1) = T(2, 2) = std::cos(angle);
  T(2, 1) = std::sin(angle);
  T(1, 2) = -T(2, 1);
  return T;
}

Eigen::Matrix4d TurnZ(double angle) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T(0, 0) = T(1, 1) = std::cos(angle);
  T(1, 0) = std::sin(angle);
  T(0, 1) = -T(1, 0);
  return T;
}

Eigen::Matrix4d Move(double x, double z) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T(0, 3) = x;
  T(2, 3) = z;
  return T;
}

/// Each column: how a mass moves with one joint, m.
Eigen::MatrixXd Slopes(const ChainOfLinks& chain, const PointMass& mass, const Eigen::VectorXd& q) {
  Eigen::MatrixXd slopes(3, q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    Eigen::VectorXd up = q, down = q;
    up[i] += kStep;
    down[i] -= kStep;
    slopes.col(i) = (chain.Point(up, mass) - chain.Point(down, mass)) / (2 * kStep);
  }
  return slopes;
}

}  // namespace

Eigen::Matrix4d ChainOfLinks::Frame(const Eigen::VectorXd& q, int link) const {
  Eigen::Matrix4d T = arm_.T_RB.Matrix();
  for (int i = 0; i <= link; ++i) {
    const ArmJoint& joint = arm_.joints[i];
    const bool turns = joint.type == JointType::kRevolute;
    const double theta = joint.theta_rad + (turns ? q[i] : 0.0);
    const double d = joint.d_m + (turns ? 0.0 : q[i]);
    if (arm_.convention == ArmConvention::kModifiedDh) {
      T = T * TurnX(joint.alpha_rad) * Move(joint.a_m, 0.0) * TurnZ(theta) * Move(0.0, d);
    } else {
      T = T * TurnZ(theta) * Move(0.0, d) * Move(joint.a_m, 0.0) * TurnX(joint.alpha_rad);
    }
  }
  return T;
}

Eigen::Vector3d ChainOfLinks::Point(const Eigen::VectorXd& q, const PointMass& mass) const {
  return (Frame(q, mass.link) * mass.p_m.homogeneous()).head<3>();
}

LinkDynamics DynamicsOf(const ChainOfLinks& chain, const std::vector<PointMass>& masses,
                        const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                        const Eigen::Vector3d& gravity_m_s2) {
  // A mass that the joints carry along accelerates by its slopes times theirs, and by how the
  // slopes turn on the way.
  constexpr double h = 1e-4;
  LinkDynamics dynamics{Eigen::MatrixXd::Zero(q.size(), q.size()), Eigen::VectorXd::Zero(q.size())};
  for (const PointMass& mass : masses) {
    const Eigen::MatrixXd J = Slopes(chain, mass, q);
    const Eigen::Vector3d carried =
        (chain.Point(q + h * v, mass) - 2.0 * chain.Point(q, mass) + chain.Point(q - h * v, mass)) /
        (h * h);
    dynamics.M += mass.mass_kg * J.transpose() * J;
    dynamics.rest += mass.mass_kg * J.transpose() * (carried - gravity_m_s2);
  }
  return dynamics;
}

}  // namespace flextip::simulation
