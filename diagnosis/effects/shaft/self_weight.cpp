#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

class SelfWeight : public Effect {
 public:
  std::string Name() const override { return "self_weight"; }
  std::string Summary() const override { return "the shaft sags under gravity"; }
  bool Applies(const SampleSet& samples) const override { return samples.gravity_m_s2.norm() > 0; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    nominal_kg_m_ = samples.instrument.mass_per_length_kg_m;
    return WithTypical(ToleranceOf(samples, Name(), kParameter, 0.003), 0.05);
  }
  void Apply(const double*, const Instant& now, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i)
      change.Linear(0, sample_input::kWeight + i, now.samples.gravity_m_s2[i]);
  }
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override {
    return {{kParameter, {nominal_kg_m_ + theta[0]}, {std::sqrt(covariance(0, 0))}}};
  }
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override {
    return Eigen::VectorXd::Constant(1, values.at(0).at(0) - nominal_kg_m_);
  }

 private:
  static constexpr const char* kParameter = "mass_per_length_kg_m";
  mutable double nominal_kg_m_ = 0.0;
};

}  // namespace

std::unique_ptr<Effect> MakeSelfWeight() { return std::make_unique<SelfWeight>(); }

}  // namespace flextip::diagnosis
