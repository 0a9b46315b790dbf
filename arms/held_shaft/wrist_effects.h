// Effects of an arm's joints as effects of the wrist that they carry.
#pragma once

#include <memory>
#include <tuple>

#include "arms/effects/effect.h"
#include "diagnosis/model/effect.h"

namespace flextip::arms {

/// The arm, and when the wrist was first sampled, on its joints' time line.
struct HeldArm {
  ArmData data;
  double wrist_starts_s = 0.0;
};

/// The row of a track at a time; before and after it, its first and last.
Where WhereAt(const Track& track, double t_s);

/// The wrist for joints `q`, and how they move it.
struct WristByJoints {
  Pose T_RW;
  Eigen::MatrixXd J;  ///< 6 x n, in R: place, then turn
  WristByJoints(const ArmData& data, const Eigen::VectorXd& q);
  WristByJoints(const ArmData& data, const Kinematics& kinematics, const Eigen::VectorXd& q);
};

/// Of an arm's effect that adds shapes of the joints, linear in its parameters.
std::unique_ptr<diagnosis::Effect> MakeWristEffect(const std::shared_ptr<const HeldArm>& data,
                                                   std::unique_ptr<ArmEffect> effect);

/// Of an arm with more joints no play is replayed.
inline constexpr int kMostJointsOfPlay = int(std::tuple_size_v<diagnosis::EffectMemory>) - 1;

/// joint_backlash: each joint follows its encoder through a play. Where it stands at the first
/// sample is each recording's own.
std::unique_ptr<diagnosis::Effect> MakeWristPlay(const std::shared_ptr<const HeldArm>& data);

/// link_geometry.
std::unique_ptr<diagnosis::Effect> MakeWristGeometry(const std::shared_ptr<const HeldArm>& data);

}  // namespace flextip::arms
