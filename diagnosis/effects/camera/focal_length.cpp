#include <cmath>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// Fitted as the logarithm of the scale, which moves the tip in depth, and beside it as what the
/// change turns the tags' pose by: how much that is hangs on how the pose was found.
class FocalLength : public Effect {
 public:
  std::string Name() const override { return "focal_length"; }
  std::string Summary() const override { return "the zoom or focus moved after calibration"; }
  bool Applies(const SampleSet& samples) const override {
    return samples.has_tip && samples.has_camera;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    const double tolerance = ToleranceOf(samples, Name(), "scale", 0.002)[0];
    return WithTypical({tolerance, tolerance}, 0.04);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    change.Linear(0, sample_input::kLogFocal, 1.0);
    change.Linear(1, sample_input::kFocalTurn, 1.0);
  }
  /// Each motion is seen from elsewhere.
  std::vector<int> OwnParameters() const override { return {1}; }
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override {
    const double scale = std::exp(theta[0]);
    return {{"scale", {scale}, {scale * std::sqrt(covariance(0, 0))}},
            {"turn", {theta[1]}, {std::sqrt(covariance(1, 1))}, true}};
  }
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override {
    return Eigen::Vector2d(std::log(values.at(0).at(0)), values.at(1).at(0));
  }
};

}  // namespace

std::unique_ptr<Effect> MakeFocalLength() { return std::make_unique<FocalLength>(); }

}  // namespace flextip::diagnosis
