#include "diagnosis/model/extended_effect.h"

#include <fmt/format.h>

#include <cmath>

#include "diagnosis/effects/registration.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {

std::unique_ptr<Effect> MakeEffectOfModel(const std::string& name) {
  auto effect = MakeEffect(name);
  if (effect) return effect;
  auto registration = std::make_unique<Registration>();
  if (registration->Name() == name) return registration;
  return nullptr;
}

std::vector<ReportedParameter> ParametersOf(const Effect& effect) {
  const auto n = static_cast<Eigen::Index>(effect.Parameters(SampleSet{}).size());
  auto parameters = effect.Report(Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n));
  for (ReportedParameter& parameter : parameters) parameter.sd.clear();
  return parameters;
}

bool MayBeMissing(const std::string& effect, const std::string& parameter) {
  return (effect == "focal_length" && parameter == "turn") ||
         (effect == "backlash" && parameter == "start_m") ||
         (effect == "port_motion" && parameter.starts_with("overtone_"));
}

std::string WhatIsWrong(const Effect& effect, const std::vector<std::vector<double>>& values) {
  const Eigen::VectorXd theta = effect.FromReported(values);
  const std::vector<FitParameter> fitted = effect.Parameters(SampleSet{});
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    if (!std::isfinite(theta[j])) return "its values mean nothing (a scale must be positive)";
    if (fitted[j].positive && theta[j] < 0) {
      return fmt::format("found {}, expected a number of at least 0", theta[j]);
    }
  }
  if (effect.Name() == "strain_gain") {
    for (const double gain : values.at(0))
      if (!(gain > 0)) return fmt::format("found a gain of {}, expected more than 0", gain);
  }
  return "";
}

}  // namespace flextip::diagnosis
