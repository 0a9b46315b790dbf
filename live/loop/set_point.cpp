#include "live/loop/set_point.h"

#include "core/rotation.h"

namespace flextip::live {

Pose SetPoint(const Pose& T_RW, const Eigen::Vector3d& p_RW_command, const Eigen::Vector3d& p_RP) {
  constexpr double kNear_m = 1e-3;
  const Eigen::Vector3d before = p_RP - T_RW.p, after = p_RP - p_RW_command;
  if (before.norm() < kNear_m || after.norm() < kNear_m) return {T_RW.R, p_RW_command};
  return {RotationWithoutTwist(before.normalized(), after.normalized()) * T_RW.R, p_RW_command};
}

}  // namespace flextip::live
