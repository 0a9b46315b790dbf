#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class TipCompliance : public DirectEffect {
 public:
  std::string Name() const override { return "tip_compliance"; }
  std::string Summary() const override { return "the distal end yields under the tip force"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_tip; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return Positive(WithTypical(ToleranceOf(samples, Name(), "compliance_m_N", 3e-05), 0.0008));
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kTipCompliance, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"compliance_m_N"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeTipCompliance() { return std::make_unique<TipCompliance>(); }

}  // namespace flextip::diagnosis
