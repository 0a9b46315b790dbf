// A robot arm as its file says it is: arm.yaml or a URDF (docs/formats.md).
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/pose.h"

namespace flextip {

enum class JointType : std::uint8_t { kRevolute, kPrismatic };

/// "rad" or "m".
inline const char* UnitOf(JointType type) { return type == JointType::kRevolute ? "rad" : "m"; }
/// "Nm" or "N".
inline const char* EffortUnitOf(JointType type) {
  return type == JointType::kRevolute ? "Nm" : "N";
}

/// A joint with what is fixed before and after it: T = before * motion(q + zero) * after, the
/// motion about or along `axis`, a unit vector in the frame after `before`. Denavit and
/// Hartenberg's four numbers are kept where the file gives them.
struct ArmJoint {
  std::string name;
  JointType type = JointType::kRevolute;
  double a_m = 0.0, alpha_rad = 0.0, d_m = 0.0, theta_rad = 0.0;
  Pose before, after;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double zero = 0.0;
};

/// Mass and its centre in the link's own frame, that after its joint.
struct ArmLink {
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
};

/// Where something may hang. On a link: `p_m` in the frame after joint `link` (from 1). On a bar of
/// a parallelogram: the bar hangs at `bar_m` (x, y of the frame after the next joint) and keeps the
/// orientation of the frame after joint `keeps_orientation_of`; `along_m` is along its x axis.
struct PayloadPlace {
  std::string name;
  int link = 0;
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();
  int keeps_orientation_of = 0;  ///< 0: on a link
  Eigen::Vector2d bar_m = Eigen::Vector2d::Zero();
  double along_m = 0.0;

  /// The link it moves with, from 1; a bar counts to the link that swings it.
  int MovesWith() const { return keeps_orientation_of > 0 ? keeps_orientation_of + 1 : link; }
};

enum class ArmConvention : std::uint8_t { kModifiedDh, kDh, kUrdf };

struct Arm {
  ArmConvention convention = ArmConvention::kModifiedDh;
  std::vector<ArmJoint> joints;
  Pose T_RB;                                 ///< the arm's base in R
  std::optional<Pose> T_LK;                  ///< the marker on the last link, where it is known
  std::vector<ArmLink> links;                ///< one a joint, or none: masses are unknown
  std::vector<PayloadPlace> payload_places;  ///< may be empty

  int Size() const { return static_cast<int>(joints.size()); }
};

/// Fills `before`, `after` and `zero` from the four numbers by the convention.
void PlaceJoint(ArmConvention convention, ArmJoint& joint);

}  // namespace flextip
