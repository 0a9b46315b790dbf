#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class StrainDrift : public DirectEffect {
 public:
  std::string Name() const override { return "strain_drift"; }
  std::string Summary() const override { return "gages warm up"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_strain && samples.resolved_in_time;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "rate_Nm_s", 2e-05, 4), 0.0005);
  }
  void Apply(const double*, const Instant& now, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 4; ++i) change.Linear(i, sample_input::kStrainOffset + i, now.t_s);
  }
  std::vector<int> OwnParameters() const override { return {0, 1, 2, 3}; }

 protected:
  std::vector<Named> Names() const override { return {{"rate_Nm_s", 4}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeStrainDrift() { return std::make_unique<StrainDrift>(); }

}  // namespace flextip::diagnosis
