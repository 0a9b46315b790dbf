#include "diagnosis/effects/mean_load.h"

#include <cmath>
#include <numbers>

namespace flextip {
namespace {

constexpr double kConstant = 1.0, kWave = 0.5;  // prior standard deviations
constexpr int kWaves = 4;                       // half periods over the recording

}  // namespace

std::vector<FitParameter> MeanLoad::Parameters(const SampleSet& samples) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const DiagnosisSample& sample : samples.samples)
    sum += (samples.p_RP - sample.p_RW).normalized();
  along_ = sum.normalized();
  std::vector<FitParameter> all(3, {kConstant, kConstant, false});
  if (samples.resolved_in_time) all.resize(3 + kWaves, {kWave, kWave, false});
  return all;
}

void MeanLoad::Apply(const double*, const Moment& now, EffectMemory&, InputChange& change) const {
  const Instrument& shaft = now.samples.instrument;
  const double unit_N = shaft.bending_stiffness_Nm2 / (shaft.length_m * shaft.length_m) *
                        std::exp(change.Input(model_input::kStiffness));
  for (int i = 0; i < 3; ++i) change.Linear(i, model_input::kForce + i, unit_N);
  if (!now.samples.resolved_in_time) return;
  for (int w = 0; w < kWaves; ++w) {
    const double wave = std::cos((w + 1) * std::numbers::pi * now.t_s / now.samples.Duration());
    for (int i = 0; i < 3; ++i)
      change.Linear(3 + w, model_input::kForce + i, unit_N * wave * along_[i]);
  }
}

std::vector<ReportedParameter> MeanLoad::Report(const Eigen::VectorXd& theta,
                                                const Eigen::MatrixXd& covariance) const {
  ReportedParameter slow{"slow_force", {}, {}};
  for (int j = 0; j < theta.size(); ++j) {
    slow.value.push_back(theta[j]);
    slow.sd.push_back(std::sqrt(covariance(j, j)));
  }
  return {slow};
}

Eigen::VectorXd MeanLoad::FromReported(const std::vector<std::vector<double>>& values) const {
  return Eigen::Map<const Eigen::VectorXd>(values.at(0).data(), Eigen::Index(values.at(0).size()));
}

}  // namespace flextip
