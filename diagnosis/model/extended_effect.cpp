#include "diagnosis/model/extended_effect.h"

#include "diagnosis/effects/registration.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {

std::unique_ptr<Effect> MakeEffectOfModel(const std::string& name, const EffectMakers& own) {
  auto effect = MakeEffect(name, own);
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

}  // namespace flextip::diagnosis
