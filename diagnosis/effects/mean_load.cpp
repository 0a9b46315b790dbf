#include "diagnosis/effects/mean_load.h"

#include <cmath>
#include <numbers>

namespace flextip::diagnosis {
namespace {

constexpr double kConstant = 1.0, kWave = 0.5;  // prior standard deviations
constexpr int kWaves = 4;                       // half periods over the recording

}  // namespace

std::vector<FitParameter> MeanLoad::Parameters(const SampleSet&) const {
  std::vector<FitParameter> all(3, {kConstant, kConstant, false});
  all.resize(3 + kWaves, {kWave, kWave, false});
  return all;
}

void MeanLoad::Apply(const double*, const Instant& now, EffectMemory&, InputChange& change) const {
  const Instrument& shaft = now.samples.instrument;
  const double unit_N = shaft.bending_stiffness_Nm2 / (shaft.length_m * shaft.length_m) *
                        std::exp(change.Input(sample_input::kStiffness));
  for (int i = 0; i < 3; ++i) change.Linear(i, sample_input::kForce + i, unit_N);
  if (!now.samples.resolved_in_time) return;
  const Eigen::Vector3d along = (now.samples.p_RP - now.samples.samples[now.k].p_RW).normalized();
  for (int w = 0; w < kWaves; ++w) {
    const double wave = std::cos((w + 1) * std::numbers::pi * now.t_s / now.samples.Duration());
    for (int i = 0; i < 3; ++i)
      change.Linear(3 + w, sample_input::kForce + i, unit_N * wave * along[i]);
  }
}

std::vector<DirectEffect::Named> MeanLoad::Names() const {
  return {{"constant", 3}, {"along", kWaves}};
}

}  // namespace flextip::diagnosis
