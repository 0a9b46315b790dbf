#include <cmath>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// Fitted as the logarithm of the scale: positive whatever the step, and nearer to linear.
class Stiffness : public Effect {
 public:
  std::string Name() const override { return "stiffness"; }
  std::string Summary() const override { return "the shaft is stiffer or softer than nominal"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    return WithTypical(ToleranceOf(samples, Name(), "scale", 0.02), 0.2);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kStiffness, 1.0);
  }
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override {
    const double scale = std::exp(theta[0]);
    return {{"scale", {scale}, {scale * std::sqrt(covariance(0, 0))}}};
  }
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override {
    return Eigen::VectorXd::Constant(1, std::log(values.at(0).at(0)));
  }
};

}  // namespace

std::unique_ptr<Effect> MakeStiffness() { return std::make_unique<Stiffness>(); }

}  // namespace flextip::diagnosis
