#include "diagnosis/effects/scale.h"

#include <cmath>

namespace flextip::diagnosis {

std::vector<FitParameter> ScaleEffect::Parameters(const SampleSet& samples) const {
  return WithTypical(ToleranceOf(samples, name_, "scale", tolerance_), typical_);
}

std::vector<ReportedParameter> ScaleEffect::Report(const Eigen::VectorXd& theta,
                                                   const Eigen::MatrixXd& covariance) const {
  const double scale = std::exp(theta[0]);
  return {{"scale", {scale}, {scale * std::sqrt(covariance(0, 0))}}};
}

Eigen::VectorXd ScaleEffect::FromReported(const std::vector<std::vector<double>>& values) const {
  return Eigen::VectorXd::Constant(1, std::log(values.at(0).at(0)));
}

}  // namespace flextip::diagnosis
