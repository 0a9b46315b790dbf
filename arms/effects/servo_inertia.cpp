// A joint stays behind an accelerating command by what its inertia stretches its servo. A nuisance:
// no file states it, and without it a lag and a delay would take it up between them.
#include "arms/effects/effects.h"
#include "arms/effects/late.h"

namespace flextip::arms {
namespace {

constexpr double kSize_s2 = 3e-5;  // a servo that would swing at 30 Hz

class ServoInertia : public PlainEffect {
 public:
  std::string Name() const override { return "servo_inertia"; }
  std::string Summary() const override { return "what inertia stretches the servos"; }
  bool Applies(const ArmData& data) const override { return ActsOnMotion(data); }
  bool IsAnswer() const override { return false; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return std::vector<FitParameter>(data.Size(), {kSize_s2});
  }
  void ActOnCommand(const ArmData& data, const double* theta, JointStage& stage) const override {
    for (int i = 0; i < data.Size(); ++i) {
      const Eigen::VectorXd& t = stage.input.t_s;
      const Eigen::VectorXd acceleration = Slopes(t, Slopes(t, stage.output.col(i)));
      stage.Linear(i, i, theta[i], -acceleration);
    }
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"inertia_over_stiffness_s2", data.Size()}};
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeServoInertia() { return std::make_unique<ServoInertia>(); }

}  // namespace flextip::arms
