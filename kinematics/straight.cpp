#include "kinematics/straight.h"

#include <cmath>

namespace flextip {

const char* Name(StraightStatus status) {
  switch (status) {
    case StraightStatus::kOk:
      return "ok";
    case StraightStatus::kBadInput:
      return "bad input";
    case StraightStatus::kOnPort:
      return "wrist on the port";
    case StraightStatus::kUnreachable:
      return "port out of reach";
  }
  return "?";
}

StraightShaft SolveStraight(const Eigen::Vector3d& p_wrist, const Eigen::Vector3d& p_port,
                            double length_m) noexcept {
  StraightShaft shaft;
  const Eigen::Vector3d to_port = p_port - p_wrist;
  const double distance = to_port.norm();
  if (!std::isfinite(distance) || !std::isfinite(length_m) || length_m <= 0) return shaft;
  if (distance < 1e-9 * length_m) {
    shaft.status = StraightStatus::kOnPort;
    return shaft;
  }
  if (distance >= length_m) {
    shaft.status = StraightStatus::kUnreachable;
    return shaft;
  }
  shaft.status = StraightStatus::kOk;
  shaft.t = to_port / distance;
  shaft.p_tip = p_wrist + length_m * shaft.t;  // (3.27)
  // d t / d p_port = (I - t t^T) / distance; a shift of both shifts the tip as much.
  shaft.J_tip_port =
      (length_m / distance) * (Eigen::Matrix3d::Identity() - shaft.t * shaft.t.transpose());
  shaft.J_tip_wrist = Eigen::Matrix3d::Identity() - shaft.J_tip_port;
  return shaft;
}

}  // namespace flextip
