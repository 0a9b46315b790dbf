// An effort's zero drifts from one session to the next: it looks like a load that no motion moves.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

class TorqueDrift : public PlainEffect {
 public:
  std::string Name() const override { return "torque_drift"; }
  std::string Summary() const override { return "an effort's zero drifts between recordings"; }
  bool Applies(const ArmData& data) const override { return data.torque.Any(); }
  bool MayChange() const override { return true; }
  bool OnlyChanges() const override { return true; }
  bool ComesAndGoes() const override { return true; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return PerJoint(data, "torque_drift.offset", {0.01, 0.05, 0.05, 0.3});
  }
  void ActOnEffort(const ArmData& data, EffortStage& stage) const override {
    const Eigen::Index joints = data.torque.track.values.cols();
    for (int i = 0; i < int(joints); ++i) {
      Eigen::MatrixXd shape = Eigen::MatrixXd::Zero(data.torque.track.Rows(), joints);
      shape.col(i).setOnes();
      stage.Add(i, std::move(shape));
    }
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override { return {{"offset", data.Size()}}; }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeTorqueDrift() { return std::make_unique<TorqueDrift>(); }

}  // namespace flextip::arms
