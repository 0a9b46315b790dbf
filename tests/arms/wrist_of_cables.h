// Two joints of a wrist behind springs, with friction, moved by forces in time: what a play that
// drags is made of. By other means than arms/effects/play.h, which solves for states.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/arms/made_arm.h"

namespace flextip::arms {

/// The second joint's cable runs over the first: it stretches by e = y - m_y + over (x - m_x).
/// Forces in units of the first joint's stiffness per rad.
struct WristOfCables {
  double over = 0.6;                          ///< how far the cable is drawn by the first joint
  double stiffness = 2.5;                     ///< of the cable, over the first joint's
  double friction_x = 0.1, friction_y = 0.3;  ///< rad, as stretched springs of the first joint
  double spring_x = 0.0, spring_y = 0.0;      ///< that pull joints back to zero

  /// How far each joint moves while each play is crossed (rows: joints).
  Eigen::Matrix2d Moved() const {
    Eigen::Matrix2d moved;
    moved << 2.0 * friction_x, -2.0 * over * friction_y, -2.0 * over * friction_x,
        2.0 * friction_y / stiffness + 2.0 * over * over * friction_y;
    return HowFar() * moved;
  }

  /// By how many widths of its play a spring draws each joint back, per rad.
  Eigen::Vector2d PullBack() const {
    return {spring_x / (2.0 * friction_x), spring_y / (2.0 * friction_y)};
  }

  /// Where joints stand without friction, per motors' angles.
  Eigen::Matrix2d HowFar() const {
    Eigen::Matrix2d yielding;  // joints' angles per moment
    yielding << 1.0, -over, -over, 1.0 / stiffness + over * over;
    const Eigen::Matrix2d springs = Eigen::Vector2d(spring_x, spring_y).asDiagonal();
    return (Eigen::Matrix2d::Identity() + yielding * springs).inverse();
  }

  /// Returns where the joints (rows x 2) follow `motors`, from `at`.
  Eigen::MatrixXd Follow(const Eigen::MatrixXd& motors, Eigen::Vector2d at) const {
    constexpr int kParts = 10, kSteps = 60;
    const double rate = 0.9 / (1.0 + stiffness * (1.0 + over) * (1.0 + over) + spring_x + spring_y);
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
          const double force_x = -(at.x() - m.x()) - over * stiffness * stretch - spring_x * at.x();
          at.x() += rate * flow(force_x, friction_x);
          at.y() += rate * flow(-stiffness * stretch - spring_y * at.y(), friction_y);
        }
      }
      joints.row(k) = at.transpose();
    }
    return joints;
  }
};

/// An arm whose two last joints are such a wrist, seen with noise. `begins`: where in their plays
/// they stand at first.
inline Recording RecordedWrist(const WristOfCables& wrist, const std::vector<double>& noise,
                               unsigned seed, double begins) {
  Recording recording = ArmRecording(SixJoints());
  recording.joints_command0 = SmoothMotion(*recording.arm, 900, 4.0, seed);
  JointStream seen = *recording.joints_command0;
  Eigen::MatrixXd motors(Eigen::Index(seen.q.size()), 2);
  for (Eigen::Index k = 0; k < motors.rows(); ++k)
    motors.row(k) << seen.q[k].value[4], seen.q[k].value[5];
  const Eigen::Vector2d at =
      wrist.HowFar() * motors.row(0).transpose() + wrist.Moved() * Eigen::Vector2d(begins, -begins);
  const Eigen::MatrixXd joints = wrist.Follow(motors, at);
  for (Eigen::Index k = 0; k < motors.rows(); ++k) {
    seen.q[k].value[4] = joints(k, 0);
    seen.q[k].value[5] = joints(k, 1);
  }
  recording.joints_seen0 = WithNoise(seen, noise, seed);
  return recording;
}

}  // namespace flextip::arms
