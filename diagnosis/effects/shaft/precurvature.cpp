#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class Precurvature : public DirectEffect {
 public:
  std::string Name() const override { return "precurvature"; }
  std::string Summary() const override { return "the unloaded shaft is bent"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "curvature_1_m", 0.003, 2), 0.1);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 2; ++i) change.Linear(i, sample_input::kCurvature + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"curvature_1_m", 2}}; }
};

}  // namespace

std::unique_ptr<Effect> MakePrecurvature() { return std::make_unique<Precurvature>(); }

}  // namespace flextip::diagnosis
