#include "core/rotation.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// The true force is the one read, turned back.
class LoadRotation : public DirectEffect {
 public:
  std::string Name() const override { return "load_rotation"; }
  std::string Summary() const override { return "the load cell is mounted askew"; }
  bool Applies(const SampleSet& samples) const override { return samples.LoadStandsOut(); }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "rotation_rad", 0.005, 3), 0.08);
  }
  void Apply(const double* theta, const Instant& now, EffectMemory&,
             InputChange& change) const override {
    const Eigen::Vector3d w(theta[0], theta[1], theta[2]);
    const Eigen::Vector3d read = now.samples.samples[now.k].f_around_N;
    const Eigen::Vector3d force = ExpRotation(-w) * read;
    // By w: Exp(-w - dw) = Exp(-J dw) Exp(-w), J the left Jacobian at -w.
    const Eigen::Matrix3d slope = Skew(force) * LeftJacobian(-w);
    for (int i = 0; i < 3; ++i) {
      change.Add(sample_input::kForce + i, force[i] - read[i]);
      for (int j = 0; j < 3; ++j) change.Derivative(j, sample_input::kForce + i, slope(i, j));
    }
  }

 protected:
  std::vector<Named> Names() const override { return {{"rotation_rad", 3}}; }
};

}  // namespace

std::unique_ptr<Effect> MakeLoadRotation() { return std::make_unique<LoadRotation>(); }

}  // namespace flextip::diagnosis
