#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// What is stamped t was taken at t + rate t: a delay of -rate t.
class EmClock : public DirectEffect {
 public:
  std::string Name() const override { return "em_clock"; }
  std::string Summary() const override { return "the EM system runs by a clock of its own"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_em && samples.resolved_in_time;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "rate", 0.00001), 0.0003);
  }
  void Apply(const double*, const Instant& now, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kEmDelay, -now.t_s);
  }
  int DelayInput() const override { return sample_input::kEmDelay; }
  bool DelayGrows() const override { return true; }

 protected:
  std::vector<Named> Names() const override { return {{"rate"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeEmClock() { return std::make_unique<EmClock>(); }

}  // namespace flextip::diagnosis
