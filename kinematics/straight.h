// The straight shaft: the lever equation (3.27) and its Jacobians, on which commercial robots rely.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

namespace flextip {

enum class StraightStatus : std::uint8_t {
  kOk,
  kBadInput,     ///< not finite, or a length that is not positive
  kOnPort,       ///< the wrist is on the port: the direction is not defined
  kUnreachable,  ///< the port is as far from the wrist as the tip, or farther
};
const char* Name(StraightStatus status);

struct StraightShaft {
  StraightStatus status = StraightStatus::kBadInput;
  Eigen::Vector3d p_tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d t = Eigen::Vector3d::UnitX();           ///< unit, from wrist to tip
  Eigen::Matrix3d J_tip_wrist = Eigen::Matrix3d::Zero();  ///< d tip / d wrist, port fixed
  Eigen::Matrix3d J_tip_port = Eigen::Matrix3d::Zero();   ///< d tip / d port, wrist fixed

  bool IsUsable() const { return status == StraightStatus::kOk; }
};

/// Solves the straight shaft of length `length_m` from `p_wrist` through `p_port` (all m, one
/// frame). With any other status than kOk, the other members stay at their defaults.
StraightShaft SolveStraight(const Eigen::Vector3d& p_wrist, const Eigen::Vector3d& p_port,
                            double length_m) noexcept;

}  // namespace flextip
