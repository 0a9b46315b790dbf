#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class CameraLatency : public DirectEffect {
 public:
  std::string Name() const override { return "camera_latency"; }
  std::string Summary() const override { return "frames are stamped late"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_tip && samples.resolved_in_time;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "delay_s", 0.003), 0.04);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kCameraDelay, 1.0);
  }
  int DelayInput() const override { return sample_input::kCameraDelay; }

 protected:
  std::vector<Named> Names() const override { return {{"delay_s"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeCameraLatency() { return std::make_unique<CameraLatency>(); }

}  // namespace flextip::diagnosis
