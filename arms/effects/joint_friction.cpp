// Effort against motion: coulomb * sign(speed) + viscous * speed, seen in torque0.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

constexpr double kStill_rad_s = 0.01, kStill_m_s = 0.001;  // the sign turns over about this speed

class JointFriction : public PlainEffect {
 public:
  std::string Name() const override { return "joint_friction"; }
  std::string Summary() const override { return "effort against the motion of a joint"; }
  bool Applies(const ArmData& data) const override { return data.torque.Any() && !data.at_stops; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    const int n = data.Size();
    const auto coulomb = ToleranceOf(data, "joint_friction.coulomb", 0.02, n);
    const auto viscous = ToleranceOf(data, "joint_friction.viscous", 0.02, n);
    std::vector<FitParameter> parameters;
    parameters.reserve(2 * std::size_t(data.Size()));
    for (int i = 0; i < n; ++i)
      parameters.push_back({coulomb[i], data.TypicalOf(i, 0.1, 1.0), true});
    for (int i = 0; i < n; ++i)
      parameters.push_back({viscous[i], data.TypicalOf(i, 0.1, 5.0), true});
    return parameters;
  }
  void ActOnEffort(const ArmData& data, EffortStage& stage) const override {
    const auto& torque = data.torque;
    const Eigen::Index rows = torque.track.Rows(), joints = torque.track.values.cols();
    const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(rows, joints);
    for (int i = 0; i < int(joints); ++i) {
      Eigen::MatrixXd coulomb = none, viscous = none;
      const double still = data.TypicalOf(i, kStill_rad_s, kStill_m_s);
      for (Eigen::Index k = 0; k < rows; ++k) {
        const double speed = At(data.rate, torque.where[k])[i];
        coulomb(k, i) = std::tanh(speed / still);
        viscous(k, i) = speed;
      }
      stage.Add(i, std::move(coulomb));
      stage.Add(data.Size() + i, std::move(viscous));
    }
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"coulomb", data.Size()}, {"viscous", data.Size()}};
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeJointFriction() { return std::make_unique<JointFriction>(); }

}  // namespace flextip::arms
