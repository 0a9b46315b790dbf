#include "diagnosis/model/effect.h"

#include <cmath>

#include "core/check.h"
#include "core/error.h"

namespace flextip::diagnosis {

std::string Effect::WhatIsWrong(const std::vector<std::vector<double>>& values) const {
  const Eigen::VectorXd theta = FromReported(values);
  const std::vector<FitParameter> fitted = Parameters(SampleSet{});
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    if (!std::isfinite(theta[j])) return "its values mean nothing (a scale must be positive)";
    if (fitted[j].positive && theta[j] < 0) {
      return fmt::format("found {}, expected a number of at least 0", theta[j]);
    }
  }
  return "";
}

std::vector<ReportedParameter> DirectEffect::Report(const Eigen::VectorXd& theta,
                                                    const Eigen::MatrixXd& covariance) const {
  std::vector<ReportedParameter> reported;
  int j = 0;
  for (const Named& named : Names()) {
    ReportedParameter parameter{named.name, {}, {}, named.may_be_missing};
    for (int i = 0; i < named.size; ++i, ++j) {
      parameter.value.push_back(named.nominal + theta[j]);
      parameter.sd.push_back(std::sqrt(std::max(0.0, covariance(j, j))));
    }
    reported.push_back(parameter);
  }
  return reported;
}

Eigen::VectorXd DirectEffect::FromReported(const std::vector<std::vector<double>>& values) const {
  std::vector<double> theta;
  const auto names = Names();
  FLEXTIP_CHECK(values.size() == names.size(), "a list of values for each reported parameter");
  for (std::size_t n = 0; n < names.size(); ++n)
    for (const double value : values[n]) theta.push_back(value - names[n].nominal);
  return Eigen::Map<Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size()));
}

std::vector<double> ToleranceOf(const SampleSet& samples, const std::string& effect,
                                const std::string& parameter, double fallback, int size) {
  const auto found = samples.tolerances.find(effect + "." + parameter);
  if (found == samples.tolerances.end()) return std::vector<double>(size, fallback);
  const auto& values = found->second;
  if (values.size() == 1) return std::vector<double>(size, values[0]);
  if (int(values.size()) != size) {
    throw InputError(fmt::format("tolerances: {}.{} has {} values, expected 1 or {}", effect,
                                 parameter, values.size(), size));
  }
  return values;
}

std::vector<FitParameter> WithTypical(const std::vector<double>& tolerances, double typical) {
  std::vector<FitParameter> parameters;
  parameters.reserve(tolerances.size());
  for (const double tolerance : tolerances) parameters.push_back({tolerance, typical, false});
  return parameters;
}

std::vector<FitParameter> Positive(std::vector<FitParameter> parameters) {
  for (FitParameter& parameter : parameters) parameter.positive = true;
  return parameters;
}

}  // namespace flextip::diagnosis
