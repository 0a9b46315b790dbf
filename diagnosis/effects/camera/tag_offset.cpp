#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class TagOffset : public DirectEffect {
 public:
  std::string Name() const override { return "tag_offset"; }
  std::string Summary() const override { return "the tag mount's place on the tip is off"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_tip; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "offset_m", 0.0002, 3), 0.002);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i) change.Linear(i, sample_input::kTagOffset + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"offset_m", 3}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeTagOffset() { return std::make_unique<TagOffset>(); }

}  // namespace flextip::diagnosis
