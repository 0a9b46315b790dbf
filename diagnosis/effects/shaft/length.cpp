#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class Length : public DirectEffect {
 public:
  std::string Name() const override { return "length"; }
  std::string Summary() const override { return "the shaft is longer or shorter than nominal"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "delta_m", 0.0003), 0.004);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kLength, 1.0);
  }

 protected:
  std::vector<Named> Names() const override { return {{"delta_m"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeLength() { return std::make_unique<Length>(); }

}  // namespace flextip::diagnosis
