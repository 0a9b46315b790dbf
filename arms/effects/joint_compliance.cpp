// A joint yields under the effort that it holds, behind its encoder: true = measured - compliance *
// effort. The effort is measured, or gravity's where the links' masses are stated.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

class JointCompliance : public PlainEffect {
 public:
  std::string Name() const override { return "joint_compliance"; }
  std::string Summary() const override { return "a joint yields under its own effort"; }
  bool Applies(const ArmData& data) const override {
    const bool any = std::find(data.effort_known.begin(), data.effort_known.end(), true) !=
                     data.effort_known.end();
    return any && (data.seen.Any() || data.pose.Any());
  }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return PerJoint(data, "joint_compliance.compliance", {0.0002, 0.00001, 0.003, 0.0001, true});
  }
  void ActOnJoints(const ArmData& data, const double* theta, JointStage& stage) const override {
    for (int i = 0; i < data.Size(); ++i)
      if (data.effort_known[i]) stage.Linear(i, i, theta[i], -stage.effort.col(i));
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"compliance", data.Size()}};
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeJointCompliance() { return std::make_unique<JointCompliance>(); }

}  // namespace flextip::arms
