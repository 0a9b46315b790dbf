#include <cmath>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// (m_y, m_z) of each station is read turned by -angle.
class GageRotation : public DirectEffect {
 public:
  std::string Name() const override { return "gage_rotation"; }
  std::string Summary() const override { return "the gages sit turned about the shaft's axis"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_strain; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "angle_rad", 0.005), 0.08);
  }
  void Apply(const double* theta, const Instant&, EffectMemory&,
             InputChange& change) const override {
    const double s = std::sin(theta[0]), c = std::cos(theta[0]);
    const auto write = [&change](int input, double value, double slope) {
      change.Add(input, value);
      change.Derivative(0, input, slope);
    };
    for (const int y : {0, 2}) {
      const int z = y + 1;
      write(sample_input::kStrainGain + y, c - 1.0, -s);
      write(sample_input::kStrainGain + z, c - 1.0, -s);
      write(StrainCross(y, z), s, c);
      write(StrainCross(z, y), -s, -c);
    }
  }

 protected:
  std::vector<Named> Names() const override { return {{"angle_rad"}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeGageRotation() { return std::make_unique<GageRotation>(); }

}  // namespace flextip::diagnosis
