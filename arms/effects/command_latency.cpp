// Commands arrive late at all joints alike.
#include "arms/effects/effects.h"
#include "arms/effects/late.h"

namespace flextip::arms {
namespace {

class CommandLatency : public PlainEffect {
 public:
  std::string Name() const override { return "command_latency"; }
  std::string Summary() const override { return "commands arrive late at all joints alike"; }
  bool Applies(const ArmData& data) const override { return ActsOnMotion(data); }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    const double tolerance = ToleranceOf(data, "command_latency.delay_s", 0.003, 1)[0];
    return {{tolerance, 0.02}};
  }
  void ActOnCommand(const ArmData& data, const double* theta, JointStage& stage) const override {
    for (int i = 0; i < data.Size(); ++i)
      stage.output.col(i) = Delayed(stage.input.t_s, stage.output.col(i), theta[0]);
  }

 protected:
  std::vector<Named> Names(const ArmData&) const override { return {{"delay_s", 1}}; }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeCommandLatency() { return std::make_unique<CommandLatency>(); }

}  // namespace flextip::arms
