#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class StrainCrosstalk : public DirectEffect {
 public:
  std::string Name() const override { return "strain_crosstalk"; }
  std::string Summary() const override { return "a gage reads part of another's moment"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_strain; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "matrix", 0.01, 12), 0.1);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 12; ++i) change.Linear(i, sample_input::kStrainCross + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"matrix", 12}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeStrainCrosstalk() { return std::make_unique<StrainCrosstalk>(); }

}  // namespace flextip::diagnosis
