#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class StrainGain : public DirectEffect {
 public:
  std::string Name() const override { return "strain_gain"; }
  std::string Summary() const override { return "a gage reads too much or too little"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_strain; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "gain", 0.01, 4), 0.15);
  }
  void Apply(const double*, const Moment&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 4; ++i) change.Linear(i, model_input::kStrainGain + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"gain", 4, 1.0}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeStrainGain() { return std::make_unique<StrainGain>(); }

}  // namespace flextip::diagnosis
