// Points of an arm's links by homogeneous matrices, and what the links' masses make of motion.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "recording/arm/arm.h"

namespace flextip::simulation {

/// A mass at a point of a link (from 0), in its frame.
struct PointMass {
  int link = 0;
  double mass_kg = 0.0;
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
};

class ChainOfLinks {
 public:
  /// By the four numbers of each joint (modified or plain Denavit-Hartenberg) and T_RB.
  explicit ChainOfLinks(const Arm& arm) : arm_(arm) {}

  int Size() const { return arm_.Size(); }
  /// 4 x 4, the frame after joint `link` in R.
  Eigen::Matrix4d Frame(const Eigen::VectorXd& q, int link) const;
  Eigen::Vector3d Point(const Eigen::VectorXd& q, const PointMass& mass) const;

 private:
  Arm arm_;
};

/// The links' equations M a + rest = forces of the joints, with gravity and Coriolis terms in rest.
struct LinkDynamics {
  Eigen::MatrixXd M;
  Eigen::VectorXd rest;
};
LinkDynamics DynamicsOf(const ChainOfLinks& chain, const std::vector<PointMass>& masses,
                        const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                        const Eigen::Vector3d& gravity_m_s2);

}  // namespace flextip::simulation
