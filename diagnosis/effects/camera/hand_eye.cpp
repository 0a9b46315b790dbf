#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class HandEye : public DirectEffect {
 public:
  std::string Name() const override { return "hand_eye"; }
  std::string Summary() const override { return "the camera is not where it was registered"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_tip; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    auto all = WithTypical(ToleranceOf(samples, Name(), "rotation_rad", 0.001, 3), 0.02);
    const auto shift = WithTypical(ToleranceOf(samples, Name(), "translation_m", 0.0002, 3), 0.003);
    all.insert(all.end(), shift.begin(), shift.end());
    return all;
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i) {
      change.Linear(i, sample_input::kCameraTurn + i, 1.0);
      change.Linear(3 + i, sample_input::kCameraShift + i, 1.0);
    }
  }

 protected:
  std::vector<Named> Names() const override { return {{"rotation_rad", 3}, {"translation_m", 3}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeHandEye() { return std::make_unique<HandEye>(); }

}  // namespace flextip::diagnosis
