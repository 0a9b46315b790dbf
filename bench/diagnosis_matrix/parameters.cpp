#include "bench/diagnosis_matrix/parameters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/diagnosis_matrix/truth.h"

namespace flextip::bench {
namespace {

/// As near to what was found as the same motion can be said.
simulation::EffectParameters TruthNear(const hidden::HiddenRecording& hidden,
                                       const diagnosis::EffectFit& fit) {
  simulation::EffectParameters truth = TruthOf(hidden, fit.effect);
  truth.erase("turn");  // the label has none: not judged
  // -a with phase + pi is the same swing.
  if (fit.effect == "port_motion" || fit.effect == "em_interference") {
    const auto& value = fit.parameters.at(0).value;
    auto& amplitude = truth["amplitude_m"];
    double product = 0.0;
    for (int i = 0; i < 3; ++i) product += amplitude[i] * value.at(i);
    if (product < 0) {
      for (double& a : amplitude) a = -a;
      truth["phase_rad"][0] += std::numbers::pi;
    }
  }
  return truth;
}

}  // namespace

std::vector<JudgedParameter> JudgeParameters(const hidden::HiddenRecording& hidden,
                                             const diagnosis::DiagnosisResult& result) {
  std::vector<JudgedParameter> judged;
  for (const diagnosis::EffectFit& fit : result.parameters) {
    const auto& present = hidden.label.present;
    if (std::find(present.begin(), present.end(), fit.effect) == present.end()) continue;
    const simulation::EffectParameters truth = TruthNear(hidden, fit);
    for (const diagnosis::ReportedParameter& parameter : fit.parameters) {
      if (!truth.contains(parameter.name)) continue;
      const std::vector<double>& values = truth.at(parameter.name);
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double value = parameter.value.at(i);
        double expected = values[i];
        if (parameter.name == "phase_rad") {
          expected = value + std::remainder(expected - value, 2.0 * std::numbers::pi);
        }
        judged.push_back(
            {fit.effect, parameter.name, static_cast<int>(i), expected, value, parameter.sd.at(i)});
      }
    }
  }
  return judged;
}

void SetBounds(const std::vector<diagnosis::EffectFit>& bounds,
               std::vector<JudgedParameter>& parameters) {
  for (JudgedParameter& judged : parameters) {
    for (const diagnosis::EffectFit& fit : bounds) {
      if (fit.effect != judged.effect) continue;
      for (const diagnosis::ReportedParameter& bound : fit.parameters)
        if (bound.name == judged.parameter) judged.bound = bound.sd.at(judged.entry);
    }
  }
}

}  // namespace flextip::bench
