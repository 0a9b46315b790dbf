// A joint stands off its command by the effort that it holds: reached = commanded - compliance *
// effort. Where no effort is known nothing can be said.
#include "arms/effects/effects.h"
#include "arms/effects/late.h"

namespace flextip::arms {
namespace {

class ServoDroop : public PlainEffect {
 public:
  std::string Name() const override { return "servo_droop"; }
  std::string Summary() const override { return "a joint stands off its command by its effort"; }
  bool Applies(const ArmData& data) const override {
    const bool any = std::find(data.effort_known.begin(), data.effort_known.end(), true) !=
                     data.effort_known.end();
    return any && ActsOnMotion(data);
  }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return PerJoint(data, "servo_droop.compliance", {0.0002, 0.00001, 0.005, 0.0002, true});
  }
  void ActOnCommand(const ArmData& data, const double* theta, JointStage& stage) const override {
    for (int i = 0; i < data.Size(); ++i)
      if (data.effort_known[i]) stage.Linear(i, i, theta[i], -stage.effort.col(i));
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"compliance", data.Size()}};
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeServoDroop() { return std::make_unique<ServoDroop>(); }

}  // namespace flextip::arms
