#include "kinematics/arm.h"

#include <algorithm>
#include <cmath>

namespace flextip {

const char* Name(ArmStatus status) {
  switch (status) {
    case ArmStatus::kOk:
      return "ok";
    case ArmStatus::kBadInput:
      return "bad input";
    case ArmStatus::kUnreachable:
      return "out of reach";
    case ArmStatus::kOutsideLimits:
      return "outside the joint limits";
  }
  return "?";
}

Eigen::Vector2d PlanarArm::Wrist(const Eigen::Vector2d& theta) const noexcept {
  const double link2_angle = theta[0] + theta[1];  // from hanging, forward
  return {link1_m * (std::cos(theta[0]) - 1.0) + link2_m * std::sin(link2_angle),
          link1_m * std::sin(theta[0]) + link2_m * (1.0 - std::cos(link2_angle))};
}

Eigen::Matrix2d PlanarArm::Jacobian(const Eigen::Vector2d& theta) const noexcept {
  const double link2_angle = theta[0] + theta[1];
  Eigen::Matrix2d J;
  J.col(1) = link2_m * Eigen::Vector2d(std::cos(link2_angle), std::sin(link2_angle));
  J.col(0) = J.col(1) + link1_m * Eigen::Vector2d(-std::sin(theta[0]), std::cos(theta[0]));
  return J;
}

PlanarArm::Inverse PlanarArm::Solve(const Eigen::Vector2d& p_wrist) const noexcept {
  Inverse result;
  if (!p_wrist.allFinite()) return result;
  // From the shoulder: link 1 at theta_1 above z, link 2 at theta_1 + theta_2 - 90 degrees.
  const Eigen::Vector2d r = p_wrist + Eigen::Vector2d(link1_m, -link2_m);
  const double distance = r.norm();
  result.status = ArmStatus::kUnreachable;
  if (distance > link1_m + link2_m || distance < std::abs(link1_m - link2_m) ||
      distance < 1e-9 * link1_m) {
    return result;
  }
  const double cos_shoulder =
      (distance * distance + link1_m * link1_m - link2_m * link2_m) / (2.0 * distance * link1_m);
  const double direction = std::atan2(r.y(), r.x());
  result.theta[0] = direction + std::acos(std::clamp(cos_shoulder, -1.0, 1.0));
  const Eigen::Vector2d along2 =
      r - link1_m * Eigen::Vector2d(std::cos(result.theta[0]), std::sin(result.theta[0]));
  result.theta[1] =
      std::remainder(std::atan2(along2.x(), -along2.y()) - result.theta[0], 2.0 * M_PI);
  result.theta[0] = std::remainder(result.theta[0], 2.0 * M_PI);
  result.status = WithinLimits(result.theta) ? ArmStatus::kOk : ArmStatus::kOutsideLimits;
  return result;
}

Eigen::Vector3d PhantomArm::Wrist(const Eigen::Vector3d& theta) const noexcept {
  const Eigen::Vector2d zy = links.Wrist(theta.tail<2>());
  const double radius = zy.x() + links.link1_m;  // from the base's axis
  return {-radius * std::sin(theta[0]), zy.y(), radius * std::cos(theta[0]) - links.link1_m};
}

Eigen::Matrix3d PhantomArm::Jacobian(const Eigen::Vector3d& theta) const noexcept {
  const Eigen::Matrix2d J_zy = links.Jacobian(theta.tail<2>());
  const double radius = links.Wrist(theta.tail<2>()).x() + links.link1_m;
  const double s = std::sin(theta[0]), c = std::cos(theta[0]);
  Eigen::Matrix3d J;
  J.col(0) = Eigen::Vector3d(-radius * c, 0.0, -radius * s);
  J.row(0).tail<2>() = -s * J_zy.row(0);
  J.row(1).tail<2>() = J_zy.row(1);
  J.row(2).tail<2>() = c * J_zy.row(0);
  return J;
}

bool PhantomArm::WithinLimits(const Eigen::Vector3d& theta) const noexcept {
  return std::abs(theta[0]) <= base_max_rad && links.WithinLimits(theta.tail<2>());
}

PhantomArm::Inverse PhantomArm::Solve(const Eigen::Vector3d& p_wrist) const noexcept {
  Inverse result;
  if (!p_wrist.allFinite()) return result;
  const double forward = p_wrist.z() + links.link1_m;
  const double radius = std::hypot(p_wrist.x(), forward);
  const PlanarArm::Inverse in_plane = links.Solve({radius - links.link1_m, p_wrist.y()});
  result.status = in_plane.status;
  if (in_plane.status == ArmStatus::kUnreachable) return result;
  result.theta << std::atan2(-p_wrist.x(), forward), in_plane.theta;
  result.status = WithinLimits(result.theta) ? ArmStatus::kOk : ArmStatus::kOutsideLimits;
  return result;
}

}  // namespace flextip
