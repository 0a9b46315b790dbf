// Two joints of a wrist behind springs, with friction, moved by forces in time: what a play that
// drags is made of. By other means than arms/effects/play.h, which solves for states.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace flextip::arms {

/// The second joint's cable runs over the first: it stretches by e = y - m_y + over (x - m_x).
/// Forces in units of the first joint's stiffness per rad.
struct WristOfCables {
  double over = 0.6;                          ///< how far the cable is drawn by the first joint
  double stiffness = 2.5;                     ///< of the cable, over the first joint's
  double friction_x = 0.1, friction_y = 0.3;  ///< rad, as stretched springs of the first joint

  /// How far each joint moves while each play is crossed (rows: joints).
  Eigen::Matrix2d Moved() const {
    Eigen::Matrix2d moved;
    moved << 2.0 * friction_x, -2.0 * over * friction_y, -2.0 * over * friction_x,
        2.0 * friction_y / stiffness + 2.0 * over * over * friction_y;
    return moved;
  }

  /// Returns where the joints (rows x 2) follow `motors`, from `at`.
  Eigen::MatrixXd Follow(const Eigen::MatrixXd& motors, Eigen::Vector2d at) const {
    constexpr int kParts = 10, kSteps = 60;
    const double rate = 0.9 / (1.0 + stiffness * (1.0 + over) * (1.0 + over));
    Eigen::MatrixXd joints(motors.rows(), 2);
    joints.row(0) = at.transpose();
    const auto flow = [](double force, double friction) {
      return std::copysign(std::max(0.0, std::abs(force) - friction), force);
    };
    for (Eigen::Index k = 1; k < motors.rows(); ++k) {
      for (int part = 1; part <= kParts; ++part) {
        const double u = double(part) / kParts;
        const Eigen::Vector2d m = ((1.0 - u) * motors.row(k - 1) + u * motors.row(k)).transpose();
        for (int i = 0; i < kSteps; ++i) {
          const double stretch = at.y() - m.y() + over * (at.x() - m.x());
          const double force_x = -(at.x() - m.x()) - over * stiffness * stretch;
          at.x() += rate * flow(force_x, friction_x);
          at.y() += rate * flow(-stiffness * stretch, friction_y);
        }
      }
      joints.row(k) = at.transpose();
    }
    return joints;
  }
};

}  // namespace flextip::arms
