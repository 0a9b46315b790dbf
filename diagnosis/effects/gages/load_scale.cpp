#include <cmath>

#include "diagnosis/effects/scale.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// The true force is the one read over the scale.
class LoadScale : public ScaleEffect {
 public:
  LoadScale()
      : ScaleEffect("load_scale", "the load cell reads too much or too little", 0.01, 0.1) {}
  bool Applies(const SampleSet& samples) const override { return samples.LoadStandsOut(); }
  void Apply(const double* theta, const Instant& now, EffectMemory&,
             InputChange& change) const override {
    const Eigen::Vector3d& read = now.samples.samples[now.k].f_around_N;
    const double inverse = std::exp(-theta[0]);
    for (int i = 0; i < 3; ++i) {
      change.Add(sample_input::kForce + i, (inverse - 1.0) * read[i]);
      change.Derivative(0, sample_input::kForce + i, -inverse * read[i]);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> MakeLoadScale() { return std::make_unique<LoadScale>(); }

}  // namespace flextip::diagnosis
