#include <cmath>

#include "diagnosis/effects/scale.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// The true wrist is its first place and the measured displacement from there over the scale.
class WristScale : public ScaleEffect {
 public:
  WristScale() : ScaleEffect("wrist_scale", "the wrist's gear ratio is off", 0.001, 0.015) {}
  bool Applies(const SampleSet&) const override { return true; }
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override {
    const Eigen::Vector3d& measured = now.samples.samples[now.k].p_RW;
    if (memory[0] == 0.0) {
      memory[0] = 1.0;
      for (int i = 0; i < 3; ++i) memory[1 + i] = measured[i];
    }
    const double inverse = std::exp(-theta[0]);
    for (int i = 0; i < 3; ++i) {
      const double moved = measured[i] - memory[1 + i];
      change.Add(sample_input::kWrist + i, (inverse - 1.0) * moved);
      change.Derivative(0, sample_input::kWrist + i, -inverse * moved);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> MakeWristScale() { return std::make_unique<WristScale>(); }

}  // namespace flextip::diagnosis
