// A joint follows its command as a first-order lag.
#include "arms/effects/effects.h"
#include "arms/effects/late.h"

namespace flextip::arms {
namespace {

class ServoLag : public PlainEffect {
 public:
  std::string Name() const override { return "servo_lag"; }
  std::string Summary() const override { return "a joint follows its command as a lag"; }
  bool Applies(const ArmData& data) const override { return ActsOnMotion(data); }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return PerJoint(data, "servo_lag.time_s", {0.003, 0.003, 0.02, 0.02, true});
  }
  void ActOnCommand(const ArmData& data, const double* theta, JointStage& stage) const override {
    for (int i = 0; i < data.Size(); ++i)
      stage.output.col(i) = Lagged(stage.input.t_s, stage.output.col(i), theta[i]);
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override { return {{"time_s", data.Size()}}; }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeServoLag() { return std::make_unique<ServoLag>(); }

}  // namespace flextip::arms
