// A gear ratio is off: true = scale * measured.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

class JointScale : public PlainEffect {
 public:
  std::string Name() const override { return "joint_scale"; }
  std::string Summary() const override { return "a gear ratio is off"; }
  bool Applies(const ArmData& data) const override { return data.seen.Any() || data.pose.Any(); }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return PerJoint(data, "joint_scale.scale", {0.0005, 0.0005, 0.01, 0.01});
  }
  bool IsLikeSprings() const override { return true; }
  void ActOnJoints(const ArmData& data, const double* theta, JointStage& stage) const override {
    for (int i = 0; i < data.Size(); ++i) stage.Linear(i, i, theta[i], stage.input.values.col(i));
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"scale", data.Size(), 1.0}};
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeJointScale() { return std::make_unique<JointScale>(); }

}  // namespace flextip::arms
