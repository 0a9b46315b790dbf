#include "diagnosis/effects/port_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
// Fitted: sine and cosine amplitudes (3 each), those of the first overtone, and a correction of the
// frequency.
constexpr int kSine = 0, kCosine = 3, kOvertoneSine = 6, kOvertoneCosine = 9, kFrequency = 12;

/// Amplitude (largest component positive), frequency and phase from the fitted parameters: the
/// phase all axes have in common.
Eigen::VectorXd Reported(const Eigen::VectorXd& theta, double frequency_hz) {
  const Eigen::Vector3d a = theta.segment<3>(kSine), b = theta.segment<3>(kCosine);
  double phase = 0.5 * std::atan2(2.0 * a.dot(b), a.squaredNorm() - b.squaredNorm());
  Eigen::Vector3d amplitude = a * std::cos(phase) + b * std::sin(phase);
  Eigen::Index largest = 0;
  amplitude.cwiseAbs().maxCoeff(&largest);
  if (amplitude[largest] < 0) {
    amplitude = -amplitude;
    phase += std::numbers::pi;
  }
  phase -= kTwoPi * std::floor(phase / kTwoPi);
  Eigen::VectorXd reported(5);
  reported << amplitude, frequency_hz + theta[kFrequency], phase;
  return reported;
}

/// Three parameters from `first` on, reported as they are.
ReportedParameter AsFitted(const char* name, int first, const Eigen::VectorXd& theta,
                           const Eigen::MatrixXd& covariance) {
  ReportedParameter parameter{name, {}, {}};
  for (int j = first; j < first + 3; ++j) {
    parameter.value.push_back(theta[j]);
    parameter.sd.push_back(std::sqrt(std::max(0.0, covariance(j, j))));
  }
  return parameter;
}

}  // namespace

bool PortMotion::Applies(const SampleSet& samples) const {
  return samples.resolved_in_time && samples.Duration() > 4.0;
}

std::vector<FitParameter> PortMotion::Parameters(const SampleSet& samples) const {
  const auto tolerance = ToleranceOf(samples, Name(), "amplitude_m", 0.0001, 3);
  std::vector<FitParameter> all;
  for (const double part : {1.0, 1.0, kOvertone, kOvertone})
    for (int i = 0; i < 3; ++i) all.push_back({part * tolerance[i], part * 0.002, false});
  const double resolution_hz = 0.3 / samples.Duration();
  all.push_back({resolution_hz, resolution_hz, false});
  return all;
}

void PortMotion::Apply(const double* theta, const Moment& now, EffectMemory&,
                       InputChange& change) const {
  const double angle = kTwoPi * (frequency_hz_ + theta[kFrequency]) * now.t_s;
  for (int i = 0; i < 3; ++i) {
    const int port = model_input::kPort + i;
    change.Linear(kSine + i, port, std::sin(angle));
    change.Linear(kCosine + i, port, std::cos(angle));
    change.Linear(kOvertoneSine + i, port, std::sin(2 * angle));
    change.Linear(kOvertoneCosine + i, port, std::cos(2 * angle));
    const double slope = theta[kSine + i] * std::cos(angle) - theta[kCosine + i] * std::sin(angle) +
                         2 * theta[kOvertoneSine + i] * std::cos(2 * angle) -
                         2 * theta[kOvertoneCosine + i] * std::sin(2 * angle);
    change.Derivative(kFrequency, port, kTwoPi * now.t_s * slope);
  }
}

std::vector<ReportedParameter> PortMotion::Report(const Eigen::VectorXd& theta,
                                                  const Eigen::MatrixXd& covariance) const {
  const Eigen::VectorXd at = Reported(theta, frequency_hz_);
  // By differences, to one side where nothing breathes, as an amplitude has its minimum there; the
  // phase is taken near the one found, so that it does not jump.
  const bool is_still = at.head<3>().isZero(0.0);
  Eigen::MatrixXd J(5, theta.size());
  for (int j = 0; j < theta.size(); ++j) {
    const double h = 1e-3 * std::max(std::sqrt(covariance(j, j)), 1e-9);
    Eigen::VectorXd plus = theta, minus = theta;
    plus[j] += h;
    if (!is_still) minus[j] -= h;
    Eigen::VectorXd d = Reported(plus, frequency_hz_) - Reported(minus, frequency_hz_);
    d[4] = std::remainder(d[4], kTwoPi);
    J.col(j) = d / (is_still ? h : 2 * h);
  }
  const Eigen::VectorXd sd = (J * covariance * J.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  return {{"amplitude_m", {at[0], at[1], at[2]}, {sd[0], sd[1], sd[2]}},
          {"frequency_hz", {at[3]}, {sd[3]}},
          {"phase_rad", {at[4]}, {std::min(sd[4], std::numbers::pi)}},
          AsFitted("overtone_sine_m", kOvertoneSine, theta, covariance),
          AsFitted("overtone_cosine_m", kOvertoneCosine, theta, covariance)};
}

Eigen::VectorXd PortMotion::FromReported(const std::vector<std::vector<double>>& values) const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(13);
  for (int i = 0; i < 3; ++i) {
    theta[kSine + i] = values.at(0).at(i) * std::cos(values.at(2).at(0));
    theta[kCosine + i] = values.at(0).at(i) * std::sin(values.at(2).at(0));
    theta[kOvertoneSine + i] = values.at(3).at(i);
    theta[kOvertoneCosine + i] = values.at(4).at(i);
  }
  theta[kFrequency] = values.at(1).at(0) - frequency_hz_;
  return theta;
}

std::unique_ptr<Effect> MakePortMotion() { return std::make_unique<PortMotion>(); }

}  // namespace flextip::diagnosis
