#include <algorithm>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// Coulomb friction that sticks. While it sticks the port stays at its place on the shaft: the
/// ratio of axial to lateral force that holds it there follows from how the place depends on that
/// ratio, and is cut off at the coefficient (a return mapping, exact as far as that dependence is
/// linear).
class PortFriction : public DirectEffect {
 public:
  std::string Name() const override { return "port_friction"; }
  std::string Summary() const override { return "the shaft rubs in the port, and sticks"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return Positive(WithTypical(ToleranceOf(samples, Name(), "coefficient", 0.03), 0.3));
  }
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override {
    if (now.ds_port_dfriction_m == 0.0) return;  // before the first replay
    // Without friction yet, its direction is that of a moderate one.
    const double coefficient = std::max(theta[0], kReference);
    double& started = memory[0];
    double& s_last_m = memory[1];
    if (started == 0.0) s_last_m = now.s_port_free_m;
    started = 1.0;
    // Along the shaft everything yields; a replay's trial compliances can be negative.
    const double ds_m = std::min(now.ds_port_dfriction_m, -kLeastYield_m);
    const double holding = (s_last_m - now.s_port_free_m) / ds_m;
    const double ratio = std::clamp(holding, -coefficient, coefficient);
    s_last_m = now.s_port_free_m + ds_m * ratio;
    change.Linear(0, sample_input::kPortFriction, ratio / coefficient);
  }
  bool NeedsPortPlace() const override { return true; }
  int HysteresisInput() const override { return sample_input::kPortFriction; }

 protected:
  std::vector<Named> Names() const override { return {{"coefficient"}}; }

 private:
  static constexpr double kReference = 0.1;
  static constexpr double kLeastYield_m = 2e-5;  // of the port's place, to a ratio of one
};

}  // namespace

std::unique_ptr<Effect> MakePortFriction() { return std::make_unique<PortFriction>(); }

}  // namespace flextip::diagnosis
