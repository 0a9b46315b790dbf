#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class PortOffset : public DirectEffect {
 public:
  std::string Name() const override { return "port_offset"; }
  std::string Summary() const override { return "the port is not where it was registered"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "offset_m", 0.0003, 3), 0.003);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i) change.Linear(i, sample_input::kPort + i, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"offset_m", 3}}; }
};

}  // namespace

std::unique_ptr<Effect> MakePortOffset() { return std::make_unique<PortOffset>(); }

}  // namespace flextip::diagnosis
