// An encoder's zero is off: true = measured + offset.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

class JointOffset : public PlainEffect {
 public:
  std::string Name() const override { return "joint_offset"; }
  std::string Summary() const override { return "an encoder's zero is off"; }
  bool Applies(const ArmData& data) const override { return data.seen.Any() || data.pose.Any(); }
  bool MayChange() const override { return true; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return PerJoint(data, "joint_offset.offset", {0.0005, 0.0002, 0.05, 0.003});
  }
  void ActOnJoints(const ArmData& data, const double* theta, JointStage& stage) const override {
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(stage.input.Rows());
    for (int i = 0; i < data.Size(); ++i) stage.Linear(i, i, theta[i], one);
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override { return {{"offset", data.Size()}}; }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeJointOffset() { return std::make_unique<JointOffset>(); }

}  // namespace flextip::arms
