// The joints' efforts for a motion, linear in masses: recursive Newton-Euler as a regressor
// (Featherstone 2008, chapter 5; Atkeson, An & Hollerbach 1986).
#pragma once

#include <Eigen/Dense>

#include "arms/model/kinematics.h"

namespace flextip::arms {

/// Numbers of one link: m, m c (3), then xx, xy, xz, yy, yz, zz of the inertia about the origin of
/// its frame, all in that frame.
inline constexpr int kLinkNumbers = 10;

struct Motion {
  Eigen::VectorXd q, v, a;  ///< joints with their rates (n each)
};

/// n x 10n: efforts = regressor * numbers of all links. `gravity_m_s2` in R.
Eigen::MatrixXd EffortRegressor(const Kinematics& arm, const Motion& motion,
                                const Eigen::Vector3d& gravity_m_s2);

/// n: efforts for a point of one kilogram at `place`.
Eigen::VectorXd PayloadEffort(const Kinematics& arm, const PayloadPlace& place,
                              const Motion& motion, const Eigen::Vector3d& gravity_m_s2);

/// The numbers of a link of that mass with all of it at its centre.
Eigen::VectorXd NumbersOf(const ArmLink& link);

}  // namespace flextip::arms
