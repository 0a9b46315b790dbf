// joint_backlash of an arm that holds a shaft: each joint rests until its encoder is half the width
// ahead of it, and is dragged along from there.
#include <algorithm>
#include <cmath>

#include "arms/held_shaft/carried_wrist.h"
#include "core/check.h"

namespace flextip::arms {
namespace {

using diagnosis::EffectMemory;
using diagnosis::InputChange;
using diagnosis::Instant;

constexpr double kWithinPlay = 0.29;  // sd of what lies anywhere within a width of one
constexpr double kSmallest = 4.0;     // tolerances: without play yet, directions are of a small one

class WristPlay : public diagnosis::DirectEffect {
 public:
  explicit WristPlay(const std::shared_ptr<const HeldArm>& data)
      : wrist_(data), widths_(PerJoint(data->data, "joint_backlash.width", kSizes)) {
    FLEXTIP_CHECK(data->data.Size() <= kMostJointsOfPlay, "a place for each joint");
  }

  std::string Name() const override { return "joint_backlash"; }
  std::string Summary() const override { return "play between encoder and joint"; }
  bool Applies(const diagnosis::SampleSet&) const override { return true; }
  /// The widths, then where in its play each joint stands at first.
  std::vector<FitParameter> Parameters(const diagnosis::SampleSet&) const override {
    std::vector<FitParameter> all = widths_;
    for (const FitParameter& width : widths_)
      all.push_back({width.tolerance * kWithinPlay, width.typical * kWithinPlay, false});
    return all;
  }

  /// `memory`: the joints, and before them which way each was dragged last, as bits; one more:
  /// begun.
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override {
    const ArmData& data = wrist_.Data();
    const int n = data.Size();
    const Eigen::VectorXd encoder = wrist_.JointsAt(wrist_.At(now));
    auto flags = unsigned(memory[0]);
    const bool first = flags == 0;
    flags |= 1U;
    Eigen::VectorXd q = encoder, by_width = Eigen::VectorXd::Zero(n),
                    by_start = Eigen::VectorXd::Zero(n);
    for (int j = 0; j < n; ++j) {
      const double width = std::max(theta[j], kSmallest * widths_[std::size_t(j)].tolerance);
      const double start = std::clamp(theta[n + j], -0.5 * width, 0.5 * width);
      double& joint = memory[std::size_t(j) + 1];
      if (first) joint = encoder[j] + start;
      const double free = joint;
      joint = std::clamp(joint, encoder[j] - 0.5 * width, encoder[j] + 0.5 * width);
      const unsigned up = 2U << unsigned(2 * j), down = up << 1U;  // which way it was dragged last
      if (joint != free) flags = (flags & ~(up | down)) | (joint > free ? up : down);
      const bool as_at_start = (flags & (up | down)) == 0;
      // A width that is smaller than the one replayed is a part of it.
      const double part = theta[j] / width;
      q[j] += part * (joint - encoder[j] - (as_at_start ? start : 0.0));
      if (as_at_start) {
        q[j] += start;
        by_start[j] = start == theta[n + j] ? 1.0 : 0.0;
      }
      by_width[j] = part < 1.0    ? (joint - encoder[j] - (as_at_start ? start : 0.0)) / width
                    : as_at_start ? 0.0
                    : flags & up  ? -0.5
                                  : 0.5;
    }
    memory[0] = double(flags);
    const WristByJoints to(data, q);
    WristMove move(WristByJoints(data, encoder), to, change);
    for (int j = 0; j < n; ++j) {
      move.Derivative(j, to.J.col(j) * by_width[j]);
      move.Derivative(n + j, to.J.col(j) * by_start[j]);
    }
  }

  std::vector<int> OwnParameters() const override {
    std::vector<int> own;
    own.reserve(widths_.size());
    for (int j = 0; j < wrist_.Data().Size(); ++j) own.push_back(wrist_.Data().Size() + j);
    return own;
  }
  std::vector<int> StateParameters() const override { return OwnParameters(); }

 protected:
  std::vector<Named> Names() const override {
    const int n = wrist_.Data().Size();
    return {{"width", n}, {"start", n, 0.0, true}};
  }

 private:
  static constexpr JointSizes kSizes{0.0005, 0.0002, 0.05, 0.002, true};
  CarriedWrist wrist_;
  std::vector<FitParameter> widths_;
};

}  // namespace

std::unique_ptr<diagnosis::Effect> MakeWristPlay(const std::shared_ptr<const HeldArm>& data) {
  return std::make_unique<WristPlay>(data);
}

}  // namespace flextip::arms
