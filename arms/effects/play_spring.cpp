// Springs that pull the joints of a wrist back to their zeros, where plays drag each other: a
// nuisance. What gives way to friction gives way to them, too: joints then stay short of their
// motors, and drag others along, by the shapes of their plays. Of a joint alone that would be a
// scale.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

class PlaySpring : public PlainEffect {
 public:
  std::string Name() const override { return "play_spring"; }
  std::string Summary() const override { return "springs that pull joints with play back"; }
  bool Applies(const ArmData& data) const override { return data.seen.Any() || data.pose.Any(); }
  bool IsAnswer() const override { return false; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    std::vector<FitParameter> parameters;
    parameters.reserve(std::size_t(data.Size()));
    for (int j = 0; j < data.Size(); ++j) parameters.push_back({data.TypicalOf(j, 0.5, 5.0), 0.0});
    return parameters;
  }
  void StartPlay(const ArmData& data, const double* theta, JointStage& stage) const override {
    stage.pull_back = Eigen::Map<const Eigen::VectorXd>(theta, data.Size());
    stage.first_pull_back = stage.First();
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"pull_back", data.Size()}};
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakePlaySpring() { return std::make_unique<PlaySpring>(); }

}  // namespace flextip::arms
