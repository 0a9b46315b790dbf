// What the wrist's effects share: joints at a sample's time, and the wrist moved in the shaft's
// inputs.
#pragma once

#include <memory>

#include "arms/held_shaft/wrist_effects.h"

namespace flextip::arms {

class CarriedWrist {
 public:
  explicit CarriedWrist(std::shared_ptr<const HeldArm> arm) : arm_(std::move(arm)) {}

  const ArmData& Data() const { return arm_->data; }
  Where At(const diagnosis::Instant& now) const;
  Eigen::VectorXd JointsAt(const Where& where) const {
    return arms::At(arm_->data.joints.values, where).transpose();
  }

 private:
  std::shared_ptr<const HeldArm> arm_;
};

/// Moves the shaft's inputs from where one set of joints has the wrist to where another has it.
class WristMove {
 public:
  WristMove(const WristByJoints& from, const WristByJoints& to, diagnosis::InputChange& change);
  /// Adds that parameter `j` moves the wrist by `twist` (place, turn; in R) per unit.
  void Derivative(int j, const Eigen::Matrix<double, 6, 1>& twist);

 private:
  diagnosis::InputChange& change_;
  Eigen::Matrix3d by_turn_;  // of the rotation vector
};

/// Returns an arm's effect as the shaft's diagnosis reports it.
std::vector<diagnosis::ReportedParameter> AsReported(const std::vector<ArmParameter>& parameters);

}  // namespace flextip::arms
