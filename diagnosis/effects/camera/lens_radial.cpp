#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// Beside k1, which displaces the line of sight, the k1 by which the tip seems nearer and the pose
/// turned: tags off the axis look larger and skewed, and what that does hangs on how the pose was
/// found.
class LensRadial : public DirectEffect {
 public:
  std::string Name() const override { return "lens_radial"; }
  std::string Summary() const override { return "the lens distorts more than calibrated"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_tip && samples.has_camera;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    const double tolerance = ToleranceOf(samples, Name(), "k1", 0.005)[0];
    return {{tolerance, kTypical, false},
            {kBeside * tolerance, kBeside * kTypical, false},
            {kBeside * tolerance, kBeside * kTypical, false}};
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kLensRadial, 1.0);
    change.Linear(1, sample_input::kLensDepth, 1.0);
    change.Linear(2, sample_input::kLensTurn, 1.0);
  }
  /// Each motion is seen from elsewhere.
  std::vector<int> OwnParameters() const override { return {1, 2}; }

 protected:
  static constexpr double kTypical = 0.08;
  /// Along the radius an image grows by 1 + 3 k1 r^2, across it by 1 + k1 r^2.
  static constexpr double kBeside = 2.0;
  std::vector<Named> Names() const override {
    return {{"k1"}, {"depth", 1, 0.0, true}, {"turn", 1, 0.0, true}};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeLensRadial() { return std::make_unique<LensRadial>(); }

}  // namespace flextip::diagnosis
