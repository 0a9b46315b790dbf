#include "bench/diagnosis_matrix/truth.h"

#include <cmath>

namespace flextip::bench {
namespace {

using Values = std::vector<std::vector<double>>;

/// An effect's reported parameters: what `truth` does not name is zero.
Values ReportedTruth(const std::vector<diagnosis::ReportedParameter>& reported,
                     const simulation::EffectParameters& truth) {
  Values values;
  for (const diagnosis::ReportedParameter& parameter : reported) {
    const auto found = truth.find(parameter.name);
    values.push_back(found == truth.end() ? std::vector<double>(parameter.value.size(), 0.0)
                                          : found->second);
  }
  return values;
}

/// The same with each number changed that `label` does not name.
Values WithOthersChanged(Values values, const std::vector<diagnosis::ReportedParameter>& reported,
                         const simulation::EffectParameters& label) {
  for (std::size_t i = 0; i < values.size(); ++i)
    for (double& value : values[i])
      if (!label.contains(reported[i].name)) value += 1.0;
  return values;
}

}  // namespace

simulation::EffectParameters TruthOf(const hidden::HiddenRecording& hidden,
                                     const std::string& effect) {
  simulation::EffectParameters truth = hidden.label.parameters.at(effect);
  if (effect == "self_weight") {  // drawn beyond the nominal one
    truth["mass_per_length_kg_m"][0] += hidden.recording.instrument.mass_per_length_kg_m;
  }
  // A pose found from tags keeps its attitude to the line of sight, which the scale moves.
  if (effect == "focal_length") truth["turn"] = {std::log(truth.at("scale").at(0))};
  // The tags' image grows by the mean of 1 + 3 k1 r^2 along the radius and 1 + k1 r^2 across.
  if (effect == "lens_radial") {
    truth["depth"] = {2.0 * truth.at("k1").at(0)};
    truth["turn"] = truth.at("k1");
  }
  return truth;
}

TrueParameters TrueTheta(const hidden::HiddenRecording& hidden,
                         diagnosis::ParameterLayout& layout) {
  TrueParameters all{Eigen::VectorXd::Zero(layout.Size()), {}};
  for (int b = 0; b < static_cast<int>(layout.Blocks().size()); ++b) {
    const auto& block = layout.Blocks()[b];
    simulation::EffectParameters truth, label;
    if (!block.nuisance) {
      truth = TruthOf(hidden, block.effect->Name());
      label = hidden.label.parameters.at(block.effect->Name());
    }
    if (truth.contains("frequency_hz"))
      layout.MutableEffect(b).SetScanCentre(truth.at("frequency_hz").at(0));
    if (truth.contains("wavelength_m"))
      layout.MutableEffect(b).SetScanCentre(1.0 / truth.at("wavelength_m").at(0));
    const auto reported = block.effect->Report(Eigen::VectorXd::Zero(block.size),
                                               Eigen::MatrixXd::Identity(block.size, block.size));
    const Values values = ReportedTruth(reported, truth);
    const Eigen::VectorXd theta = block.effect->FromReported(values);
    const Eigen::VectorXd other =
        block.effect->FromReported(WithOthersChanged(values, reported, label));
    all.theta.segment(block.first, block.size) = theta;
    for (int j = 0; j < block.size; ++j)
      if (other[j] != theta[j]) all.unnamed.push_back(block.first + j);
  }
  return all;
}

}  // namespace flextip::bench
