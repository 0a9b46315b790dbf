// The robots of the thesis that hold the instrument: a planar two-link arm (2.3.1) and its
// three-joint form (chapter 5), both after the Phantom Premium 1.5.
//
// Arm frame A, as in 2.3.1: origin at the wrist in the home position, x sideways, y up, z forward
// toward the port. At home the first link lies along z, from the shoulder at z = -210 mm, and the
// second hangs from its end along -y. Angles are measured from home: theta_1 raises the first link,
// theta_2 is the elbow's (serial) angle and opens it, so theta_1 + theta_2 is the second link's
// angle forward of the vertical. The thesis does not say whether its second angle is the elbow's or
// the link's; only as the elbow's do its limits keep the arm away from its singular position.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

namespace flextip {

enum class ArmStatus : std::uint8_t {
  kOk,
  kBadInput,       ///< not finite
  kUnreachable,    ///< no joint angles put the wrist there
  kOutsideLimits,  ///< the joint angles would be outside their limits
};
const char* Name(ArmStatus status);

/// Limits of the two joints' angles (rad from home), as printed in 2.3.1. Of the sum's limits only
/// the lower is ever met: the single limits keep the sum below 2.2.
struct LinkLimits {
  double joint1_min = -1.9, joint1_max = 1.2;
  double joint2_min = -0.7, joint2_max = 1.0;
  double sum_min = -0.3, sum_max = 2.8;

  bool Allow(double joint1, double joint2) const noexcept {
    const double sum = joint1 + joint2;
    return joint1 >= joint1_min && joint1 <= joint1_max && joint2 >= joint2_min &&
           joint2 <= joint2_max && sum >= sum_min && sum <= sum_max;
  }
};

/// The two-link arm in the plane. Positions are (z, y) in A, in this order, so that a shaft at rest
/// points along the first axis.
class PlanarArm {
 public:
  struct Inverse {
    ArmStatus status = ArmStatus::kBadInput;
    Eigen::Vector2d theta = Eigen::Vector2d::Zero();  ///< valid with kOk and kOutsideLimits
  };

  double link1_m = 0.21, link2_m = 0.21;
  LinkLimits limits;

  Eigen::Vector2d Wrist(const Eigen::Vector2d& theta) const noexcept;
  /// Returns J_r of (3.4): d wrist / d theta (2x2, m/rad). Singular with the links in line.
  Eigen::Matrix2d Jacobian(const Eigen::Vector2d& theta) const noexcept;
  bool WithinLimits(const Eigen::Vector2d& theta) const noexcept {
    return limits.Allow(theta[0], theta[1]);
  }
  /// Returns the joint angles for a wrist position (z, y) in A (m), the elbow up as at home.
  Inverse Solve(const Eigen::Vector2d& p_wrist) const noexcept;
};

/// The three-joint arm: the base turns by theta_0 about y (to -x where positive), then the two
/// links. The thesis states no limit for the base; `base_max_rad` is this program's.
class PhantomArm {
 public:
  struct Inverse {
    ArmStatus status = ArmStatus::kBadInput;
    Eigen::Vector3d theta = Eigen::Vector3d::Zero();  ///< valid with kOk and kOutsideLimits
  };

  PlanarArm links;
  double base_max_rad = 1.2;

  /// Returns the wrist (x, y, z) in A (m) for joint angles (rad).
  Eigen::Vector3d Wrist(const Eigen::Vector3d& theta) const noexcept;
  Eigen::Matrix3d Jacobian(const Eigen::Vector3d& theta) const noexcept;
  bool WithinLimits(const Eigen::Vector3d& theta) const noexcept;
  Inverse Solve(const Eigen::Vector3d& p_wrist) const noexcept;
};

}  // namespace flextip
