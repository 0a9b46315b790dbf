#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class CameraDrift : public DirectEffect {
 public:
  std::string Name() const override { return "camera_drift"; }
  std::string Summary() const override { return "the scope's holder sinks"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_tip && samples.resolved_in_time;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    auto all = WithTypical(ToleranceOf(samples, Name(), "rotation_rate_rad_s", 0.00001, 3), 0.0003);
    const auto shift =
        WithTypical(ToleranceOf(samples, Name(), "translation_rate_m_s", 0.000002, 3), 0.00005);
    all.insert(all.end(), shift.begin(), shift.end());
    return all;
  }
  void Apply(const double*, const Instant& now, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i) {
      change.Linear(i, sample_input::kCameraTurn + i, now.t_s);
      change.Linear(3 + i, sample_input::kCameraShift + i, now.t_s);
    }
  }
  std::vector<int> OwnParameters() const override { return {0, 1, 2, 3, 4, 5}; }

 protected:
  std::vector<Named> Names() const override {
    return {{"rotation_rate_rad_s", 3}, {"translation_rate_m_s", 3}};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeCameraDrift() { return std::make_unique<CameraDrift>(); }

}  // namespace flextip::diagnosis
