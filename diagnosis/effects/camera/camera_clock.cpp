#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// What is stamped t was taken at t + rate t: a delay of -rate t.
class CameraClock : public DirectEffect {
 public:
  std::string Name() const override { return "camera_clock"; }
  std::string Summary() const override { return "the camera runs by a clock of its own"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_tip && samples.resolved_in_time;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "rate", 0.00001), 0.0003);
  }
  void Apply(const double*, const Instant& now, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kCameraDelay, -now.t_s);
  }
  int DelayInput() const override { return sample_input::kCameraDelay; }
  bool DelayGrows() const override { return true; }

 protected:
  std::vector<Named> Names() const override { return {{"rate"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeCameraClock() { return std::make_unique<CameraClock>(); }

}  // namespace flextip::diagnosis
