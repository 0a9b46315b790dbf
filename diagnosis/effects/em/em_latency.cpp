#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class EmLatency : public DirectEffect {
 public:
  std::string Name() const override { return "em_latency"; }
  std::string Summary() const override { return "EM samples are stamped late"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_em && samples.resolved_in_time;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "delay_s", 0.003), 0.04);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kEmDelay, 1.0);
  }
  int DelayInput() const override { return sample_input::kEmDelay; }

 protected:
  std::vector<Named> Names() const override { return {{"delay_s"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeEmLatency() { return std::make_unique<EmLatency>(); }

}  // namespace flextip::diagnosis
