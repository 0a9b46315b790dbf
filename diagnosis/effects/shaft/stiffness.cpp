#include "diagnosis/effects/scale.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// The logarithm is positive whatever the step, and nearer to linear.
class Stiffness : public ScaleEffect {
 public:
  Stiffness()
      : ScaleEffect("stiffness", "the shaft is stiffer or softer than nominal", 0.02, 0.2) {}
  bool Applies(const SampleSet&) const override { return true; }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kStiffness, 1.0);
  }
};

}  // namespace

std::unique_ptr<Effect> MakeStiffness() { return std::make_unique<Stiffness>(); }

}  // namespace flextip::diagnosis
