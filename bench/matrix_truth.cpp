#include "bench/matrix_truth.h"

#include <cmath>

#include "diagnosis/effects/port_motion.h"

namespace flextip {
namespace {

/// An effect's reported numbers by the label, with `unnamed` for each that it does not name.
std::vector<std::vector<double>> ReportedTruth(const ParameterLayout::Block& block,
                                               const EffectParameters& truth, double unnamed) {
  std::vector<std::vector<double>> values;
  for (const ReportedParameter& parameter : block.effect->Report(
           Eigen::VectorXd::Zero(block.size), Eigen::MatrixXd::Identity(block.size, block.size))) {
    const auto found = truth.find(parameter.name);
    values.push_back(found == truth.end() ? std::vector<double>(parameter.value.size(), unnamed)
                                          : found->second);
  }
  return values;
}

}  // namespace

EffectParameters TruthOf(const HiddenRecording& hidden, const std::string& effect) {
  EffectParameters truth = hidden.label.parameters.at(effect);
  if (effect == "self_weight") {  // drawn beyond the nominal one
    truth["mass_per_length_kg_m"][0] += hidden.recording.instrument.mass_per_length_kg_m;
  }
  // A pose found from tags keeps its attitude to the line of sight, which the scale moves.
  if (effect == "focal_length") truth["turn"] = {std::log(truth.at("scale").at(0))};
  return truth;
}

TrueParameters TrueTheta(const HiddenRecording& hidden, ParameterLayout& layout) {
  TrueParameters all{Eigen::VectorXd::Zero(layout.Size()), {}};
  for (int b = 0; b < static_cast<int>(layout.Blocks().size()); ++b) {
    const auto& block = layout.Blocks()[b];
    EffectParameters truth;
    if (!block.nuisance) truth = TruthOf(hidden, block.effect->Name());
    if (block.effect->Name() == "port_motion") {
      static_cast<PortMotion&>(layout.MutableEffect(b))
          .SetFrequency(truth.at("frequency_hz").at(0));
    }
    const Eigen::VectorXd theta = block.effect->FromReported(ReportedTruth(block, truth, 0.0));
    const Eigen::VectorXd other = block.effect->FromReported(ReportedTruth(block, truth, 1.0));
    all.theta.segment(block.first, block.size) = theta;
    for (int j = 0; j < block.size; ++j)
      if (other[j] != theta[j]) all.unnamed.push_back(block.first + j);
  }
  return all;
}

}  // namespace flextip
