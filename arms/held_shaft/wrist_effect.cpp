// Effects that add shapes of the joints, linear in their parameters: offsets, scales, couplings,
// compliances. And link_geometry.
#include "arms/effects/effects.h"
#include "arms/held_shaft/carried_wrist.h"

namespace flextip::arms {
namespace {

using diagnosis::EffectMemory;
using diagnosis::InputChange;
using diagnosis::Instant;
using diagnosis::ReportedParameter;

/// An arm's effect under its own name and numbers.
class WristEffect : public diagnosis::Effect {
 public:
  WristEffect(const std::shared_ptr<const HeldArm>& arm, std::unique_ptr<ArmEffect> effect)
      : wrist_(arm), effect_(std::move(effect)) {}

  std::string Name() const override { return effect_->Name(); }
  std::string Summary() const override { return effect_->Summary(); }
  bool Applies(const diagnosis::SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const diagnosis::SampleSet&) const override {
    return effect_->Parameters(wrist_.Data());
  }
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override {
    return AsReported(effect_->Report(wrist_.Data(), theta, covariance));
  }
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override {
    const int size = int(effect_->Parameters(wrist_.Data()).size());
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(size);
    std::vector<ArmParameter> reported =
        effect_->Report(wrist_.Data(), none, Eigen::MatrixXd::Zero(size, size));
    for (std::size_t i = 0; i < reported.size() && i < values.size(); ++i)
      reported[i].value = values[i];
    return effect_->FromReported(wrist_.Data(), reported);
  }

 protected:
  CarriedWrist wrist_;
  std::unique_ptr<ArmEffect> effect_;
};

class ShapesOfJoints : public WristEffect {
 public:
  ShapesOfJoints(const std::shared_ptr<const HeldArm>& arm, std::unique_ptr<ArmEffect> effect)
      : WristEffect(arm, std::move(effect)) {
    const ArmData& data = arm->data;
    const Eigen::VectorXd none =
        Eigen::VectorXd::Zero(Eigen::Index(effect_->Parameters(data).size()));
    Eigen::MatrixXd output = data.joints.values;
    JointStage stage(data.joints, data.effort_at_joints, output, &shapes_);
    effect_->ActOnJoints(data, none.data(), stage);
  }

  void Apply(const double* theta, const Instant& now, EffectMemory&,
             InputChange& change) const override {
    const Where where = wrist_.At(now);
    const Eigen::VectorXd measured = wrist_.JointsAt(where);
    Eigen::VectorXd q = measured;
    for (const JointStage::Column& shape : shapes_)
      q[shape.joint] += theta[shape.parameter] * arms::At(shape.values, where);
    const WristByJoints to(wrist_.Data(), q);
    WristMove move(WristByJoints(wrist_.Data(), measured), to, change);
    for (const JointStage::Column& shape : shapes_) {
      move.Derivative(shape.parameter, to.J.col(shape.joint) * arms::At(shape.values, where));
    }
  }

 private:
  std::vector<JointStage::Column> shapes_;
};

class WristGeometry : public WristEffect {
 public:
  explicit WristGeometry(const std::shared_ptr<const HeldArm>& data)
      : WristEffect(data, MakeLinkGeometry()) {}

  void Apply(const double* theta, const Instant& now, EffectMemory&,
             InputChange& change) const override {
    const ArmData& data = wrist_.Data();
    const Eigen::VectorXd q = wrist_.JointsAt(wrist_.At(now));
    const Kinematics changed(
        data.arm, Eigen::Map<const Eigen::VectorXd>(theta, Eigen::Index{3} * data.Size()));
    const WristByJoints to(data, changed, q);
    WristMove move(WristByJoints(data, q), to, change);
    const Eigen::MatrixXd J =
        changed.GeometryJacobian(changed.Places(q), data.Size() - 1, to.T_RW.p);
    for (int j = 0; j < 3 * data.Size(); ++j) move.Derivative(j, J.col(j));
  }
};

}  // namespace

std::unique_ptr<diagnosis::Effect> MakeWristEffect(const std::shared_ptr<const HeldArm>& data,
                                                   std::unique_ptr<ArmEffect> effect) {
  return std::make_unique<ShapesOfJoints>(data, std::move(effect));
}

std::unique_ptr<diagnosis::Effect> MakeWristGeometry(const std::shared_ptr<const HeldArm>& data) {
  return std::make_unique<WristGeometry>(data);
}

}  // namespace flextip::arms
