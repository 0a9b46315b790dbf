// A sensor whose samples are stamped late: by a time, or by a clock of its own.
#pragma once

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// `delay_s` of the input kEmDelay or kCameraDelay.
class DelayEffect : public DirectEffect {
 public:
  std::string Name() const override { return name_; }
  std::string Summary() const override { return summary_; }
  bool Applies(const SampleSet& samples) const override {
    const bool has = input_ == sample_input::kEmDelay ? samples.has_em : samples.has_tip;
    return has && samples.resolved_in_time;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, name_, "delay_s", 0.003), 0.04);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, input_, 1.0);
  }
  int DelayInput() const override { return input_; }

 protected:
  DelayEffect(const char* name, const char* summary, int input)
      : name_(name), summary_(summary), input_(input) {}
  std::vector<Named> Names() const override { return {{"delay_s"}}; }

 private:
  const char *name_, *summary_;
  int input_;
};

/// `rate`: what is stamped t was taken at t + rate t, a delay of -rate t.
class ClockEffect : public DelayEffect {
 public:
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "rate", 0.00001), 0.0003);
  }
  void Apply(const double*, const Instant& now, EffectMemory&, InputChange& change) const override {
    change.Linear(0, DelayInput(), -now.t_s);
  }
  bool DelayGrows() const override { return true; }

 protected:
  using DelayEffect::DelayEffect;
  std::vector<Named> Names() const override { return {{"rate"}}; }
};

}  // namespace flextip::diagnosis
