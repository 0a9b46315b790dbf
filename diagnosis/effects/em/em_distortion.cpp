#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// A bias that grows linearly across the workspace. Where it is zero is not known: an offset is
/// fitted beside the gradient, as large as the gradient may make it over a few centimetres.
class EmDistortion : public Effect {
 public:
  std::string Name() const override { return "em_distortion"; }
  std::string Summary() const override { return "the EM field is bent"; }
  bool Applies(const SampleSet& samples) const override { return samples.has_em; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    const auto tolerance = ToleranceOf(samples, Name(), "gradient", 0.001, 9);
    auto all = WithTypical(tolerance, 0.015);
    for (int i = 0; i < 3; ++i) all.push_back({kCentre_m * tolerance[0], kCentre_m * 0.015, false});
    return all;
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 9; ++i) change.Linear(i, sample_input::kEmGradient + i, 1.0);
    for (int i = 0; i < 3; ++i) change.Linear(9 + i, sample_input::kEmOffset + i, 1.0);
  }
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override {
    ReportedParameter gradient{"gradient", {}, {}}, offset{"offset_at_centre_m", {}, {}};
    for (int i = 0; i < 12; ++i) {
      ReportedParameter& to = i < 9 ? gradient : offset;
      to.value.push_back(theta[i]);
      to.sd.push_back(std::sqrt(covariance(i, i)));
    }
    return {gradient, offset};
  }
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override {
    Eigen::VectorXd theta(12);
    for (int i = 0; i < 12; ++i) theta[i] = i < 9 ? values.at(0).at(i) : values.at(1).at(i - 9);
    return theta;
  }

 private:
  static constexpr double kCentre_m = 0.03;
};

}  // namespace

std::unique_ptr<Effect> MakeEmDistortion() { return std::make_unique<EmDistortion>(); }

}  // namespace flextip::diagnosis
