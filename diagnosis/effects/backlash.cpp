#include <algorithm>
#include <cmath>

#include "diagnosis/catalogue.h"

namespace flextip {
namespace {

/// The play operator on each axis: the true wrist rests until the measured one is half the width
/// ahead of it, and is dragged along from there.
class Backlash : public DirectEffect {
 public:
  std::string Name() const override { return "backlash"; }
  std::string Summary() const override { return "play between the measured and the true wrist"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return Positive(WithTypical(ToleranceOf(samples, Name(), "width_m", 0.0001), 0.001));
  }
  void Apply(const double* theta, const Moment& now, EffectMemory& memory,
             InputChange& change) const override {
    // Without play yet, its directions are those of a small one (a secant).
    const double width = std::max(theta[0], kReference_m);
    const Eigen::Vector3d& measured = now.samples.samples[now.k].p_RW;
    const bool first = memory[0] == 0.0;
    memory[0] = 1.0;
    for (int i = 0; i < 3; ++i) {
      double& wrist = memory[1 + i];
      if (first) wrist = measured[i];
      wrist = std::clamp(wrist, measured[i] - 0.5 * width, measured[i] + 0.5 * width);
      change.Linear(0, model_input::kWrist + i, (wrist - measured[i]) / width);
    }
  }

 protected:
  std::vector<Named> Names() const override { return {{"width_m"}}; }

 private:
  static constexpr double kReference_m = 0.0004;
};

}  // namespace

std::unique_ptr<Effect> MakeBacklash() { return std::make_unique<Backlash>(); }

}  // namespace flextip
