#include <algorithm>
#include <cmath>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// The play operator on each axis: the true wrist rests until the measured one is half the width
/// ahead of it, and is dragged along from there. Where in the play it stood at the first sample is
/// fitted too, axis by axis; that is forgotten once it was dragged.
class Backlash : public DirectEffect {
 public:
  std::string Name() const override { return "backlash"; }
  std::string Summary() const override { return "play between the measured and the true wrist"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    const double tolerance = ToleranceOf(samples, Name(), "width_m", 0.0001)[0];
    auto all = Positive(WithTypical({tolerance}, kTypical_m));
    for (int i = 0; i < 3; ++i)
      all.push_back({tolerance * kWithinPlay, kTypical_m * kWithinPlay, false});
    return all;
  }
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override {
    // Without play yet, its directions are those of a small one (a secant).
    const double width = std::max(theta[0], kReference_m), limit = 0.5 * width;
    const Eigen::Vector3d& measured = now.samples.samples[now.k].p_RW;
    const bool first = memory[0] == 0.0;
    memory[0] = 1.0;
    for (int i = 0; i < 3; ++i) {
      double& wrist = memory[1 + i];
      double& dragged = memory[4 + i];
      const double start = std::clamp(theta[1 + i], -limit, limit);
      if (first) wrist = measured[i] + start;
      const double free = wrist;
      wrist = std::clamp(wrist, measured[i] - limit, measured[i] + limit);
      if (wrist != free) dragged = 1.0;
      const bool as_at_start = dragged == 0.0;
      const double by_play = wrist - measured[i] - (as_at_start ? start : 0.0);
      change.Linear(0, sample_input::kWrist + i, by_play / width);
      if (!as_at_start) continue;
      change.Add(sample_input::kWrist + i, start);
      if (start == theta[1 + i]) change.Derivative(1 + i, sample_input::kWrist + i, 1.0);
    }
  }
  std::vector<int> OwnParameters() const override { return {1, 2, 3}; }
  std::vector<int> StateParameters() const override { return {1, 2, 3}; }
  double WristPlay(const Eigen::VectorXd& theta) const override { return theta[0]; }

 protected:
  std::vector<Named> Names() const override { return {{"width_m"}, {"start_m", 3, 0.0, true}}; }

 private:
  static constexpr double kTypical_m = 0.001;
  static constexpr double kWithinPlay = 0.29;  // sd of what lies anywhere within a width of one
  static constexpr double kReference_m = 0.0004;
};

}  // namespace

std::unique_ptr<Effect> MakeBacklash() { return std::make_unique<Backlash>(); }

}  // namespace flextip::diagnosis
