#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class WristCompliance : public DirectEffect {
 public:
  std::string Name() const override { return "wrist_compliance"; }
  std::string Summary() const override { return "the arm yields under the wrist force"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return Positive(WithTypical(ToleranceOf(samples, Name(), "compliance_m_N", 3e-05), 0.0008));
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kWristCompliance, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"compliance_m_N"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeWristCompliance() { return std::make_unique<WristCompliance>(); }

}  // namespace flextip::diagnosis
