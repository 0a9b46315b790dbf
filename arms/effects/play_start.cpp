// Where each joint stands in its play when a recording begins: a nuisance, each recording's own.
// A joint that never moves keeps it to the end, where it looks like an offset.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

constexpr double kSpread = 0.3;  // widths: anywhere between -1/2 and 1/2

class PlayStart : public PlainEffect {
 public:
  std::string Name() const override { return "play_start"; }
  std::string Summary() const override { return "where plays stand when a recording begins"; }
  bool Applies(const ArmData& data) const override { return data.seen.Any() || data.pose.Any(); }
  bool IsAnswer() const override { return false; }
  bool OwnInEach() const override { return true; }
  double Bound() const override { return 0.5; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    return std::vector<FitParameter>(std::size_t(data.Size()), {kSpread, 0.0});
  }
  void StartPlay(const ArmData& data, const double* theta, JointStage& stage) const override {
    stage.play_start = Eigen::Map<const Eigen::VectorXd>(theta, data.Size());
    stage.first_play_start = stage.First();
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override { return {{"start", data.Size()}}; }
};

}  // namespace

std::unique_ptr<ArmEffect> MakePlayStart() { return std::make_unique<PlayStart>(); }

}  // namespace flextip::arms
