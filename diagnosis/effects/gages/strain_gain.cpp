#include <fmt/format.h>

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
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 4; ++i) change.Linear(i, sample_input::kStrainGain + i, 1.0);
  }
  std::string WhatIsWrong(const std::vector<std::vector<double>>& values) const override {
    const std::string wrong = DirectEffect::WhatIsWrong(values);
    if (!wrong.empty()) return wrong;
    for (const double gain : values.at(0))
      if (!(gain > 0)) return fmt::format("found a gain of {}, expected more than 0", gain);
    return "";
  }

 protected:
  std::vector<Named> Names() const override { return {{"gain", 4, 1.0}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeStrainGain() { return std::make_unique<StrainGain>(); }

}  // namespace flextip::diagnosis
