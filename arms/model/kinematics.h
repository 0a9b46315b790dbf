// Where an arm's links are for given joints: forward kinematics and its derivatives.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/pose.h"
#include "recording/arm/arm.h"

namespace flextip::arms {

/// One joint and the link after it, in R.
struct LinkPlace {
  Pose T;                  ///< the frame after the joint: T_Ri
  Eigen::Vector3d axis;    ///< of the joint
  Eigen::Vector3d origin;  ///< a point on the axis, fixed to the link before the joint
  Eigen::Vector3d normal, normal_origin;  ///< Denavit and Hartenberg's x axis of the link
  Eigen::Vector3d offset_axis;            ///< along which d counts
};

class Kinematics {
 public:
  explicit Kinematics(const Arm& arm) : arm_(arm) {}
  /// The arm with its numbers changed: a, d, alpha of each link in turn (3n; m, m, rad). Has no
  /// meaning for an arm from a URDF.
  Kinematics(const Arm& arm, const Eigen::VectorXd& change);

  int Size() const { return arm_.Size(); }
  const Arm& Described() const { return arm_; }

  /// Places of all links for joints `q` (n; rad or m).
  std::vector<LinkPlace> Places(const Eigen::VectorXd& q) const;
  /// The frame after the last joint, T_RL.
  Pose Last(const Eigen::VectorXd& q) const { return Places(q).back().T; }

  /// 6 x n: how the joints move a point `p_R` of link `link` (from 0) and turn the link, in R.
  Eigen::MatrixXd Jacobian(const std::vector<LinkPlace>& places, int link,
                           const Eigen::Vector3d& p_R) const;
  /// 6 x 3n: the same by a, d and alpha of each link up to `link`.
  Eigen::MatrixXd GeometryJacobian(const std::vector<LinkPlace>& places, int link,
                                   const Eigen::Vector3d& p_R) const;

  /// The place of a payload in R, for joints `q`.
  Eigen::Vector3d PayloadPoint(const PayloadPlace& place, const Eigen::VectorXd& q) const;

 private:
  Arm arm_;
};

}  // namespace flextip::arms
