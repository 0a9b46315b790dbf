#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class ShaftLoad : public DirectEffect {
 public:
  std::string Name() const override { return "shaft_load"; }
  std::string Summary() const override { return "tissue pushes on the shaft between port and tip"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "force_per_length_N_m", 0.02, 3), 0.4);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i) change.Linear(i, sample_input::kInside + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"force_per_length_N_m", 3}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeShaftLoad() { return std::make_unique<ShaftLoad>(); }

}  // namespace flextip::diagnosis
