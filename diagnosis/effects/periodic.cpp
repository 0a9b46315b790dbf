#include "diagnosis/effects/periodic.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace flextip::diagnosis {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
// Fitted: sine and cosine amplitudes (3 each), those of the first overtone where there is one, and
// a correction of the frequency.
constexpr int kSine = 0, kCosine = 3, kOvertoneSine = 6, kOvertoneCosine = 9;

/// Returns three parameters from `first` on, reported as fitted.
ReportedParameter AsFitted(const char* name, int first, const Eigen::VectorXd& theta,
                           const Eigen::MatrixXd& covariance) {
  ReportedParameter parameter{name, {}, {}, true};
  for (int j = first; j < first + 3; ++j) {
    parameter.value.push_back(theta[j]);
    parameter.sd.push_back(std::sqrt(std::max(0.0, covariance(j, j))));
  }
  return parameter;
}

}  // namespace

PeriodicEffect::PeriodicEffect(std::string name, std::string summary,
                               const Oscillation& oscillation)
    : name_(std::move(name)),
      summary_(std::move(summary)),
      oscillation_(oscillation),
      frequency_hz_(oscillation.start_hz) {}

std::vector<FitParameter> PeriodicEffect::Parameters(const SampleSet& samples) const {
  const auto tolerance = ToleranceOf(samples, name_, "amplitude_m", oscillation_.tolerance, 3);
  std::vector<double> parts{1.0, 1.0};
  if (HasOvertone()) parts.insert(parts.end(), 2, oscillation_.overtone);
  std::vector<FitParameter> all;
  for (const double part : parts)
    for (int i = 0; i < 3; ++i)
      all.push_back({part * tolerance[i], part * oscillation_.typical, false});
  const double resolution_hz = 0.3 / samples.Duration();
  all.push_back({resolution_hz, resolution_hz, false});
  return all;
}

void PeriodicEffect::Apply(const double* theta, const Instant& now, EffectMemory&,
                           InputChange& change) const {
  const int frequency = FrequencyIndex();
  const double t_s = TimeOf(now), angle = kTwoPi * (frequency_hz_ + theta[frequency]) * t_s;
  for (int i = 0; i < 3; ++i) {
    const int input = oscillation_.first_input + i;
    change.Linear(kSine + i, input, std::sin(angle));
    change.Linear(kCosine + i, input, std::cos(angle));
    double slope = theta[kSine + i] * std::cos(angle) - theta[kCosine + i] * std::sin(angle);
    if (HasOvertone()) {
      change.Linear(kOvertoneSine + i, input, std::sin(2 * angle));
      change.Linear(kOvertoneCosine + i, input, std::cos(2 * angle));
      slope += 2 * theta[kOvertoneSine + i] * std::cos(2 * angle) -
               2 * theta[kOvertoneCosine + i] * std::sin(2 * angle);
    }
    change.Derivative(frequency, input, kTwoPi * t_s * slope);
  }
}

/// When the inputs acted that the sample shows: a reading is the one nearest to the sample's time.
double PeriodicEffect::TimeOf(const Instant& now) const {
  const DiagnosisSample& sample = now.samples.samples[now.k];
  if (oscillation_.first_input == sample_input::kEmOffset) return now.t_s + sample.dt_em_s;
  if (oscillation_.first_input == sample_input::kCameraShift) return now.t_s + sample.dt_tip_s;
  return now.t_s;
}

/// Returns amplitude (largest component positive), frequency and phase from the fitted parameters.
/// The phase is the one that the axes have in common.
Eigen::VectorXd PeriodicEffect::Reported(const Eigen::VectorXd& theta) const {
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
  reported << amplitude, frequency_hz_ + theta[FrequencyIndex()], phase;
  return reported;
}

std::vector<ReportedParameter> PeriodicEffect::Report(const Eigen::VectorXd& theta,
                                                      const Eigen::MatrixXd& covariance) const {
  const Eigen::VectorXd at = Reported(theta);
  // By differences: to one side where nothing swings, as an amplitude has its minimum there. The
  // phase is taken near the one found, so that it does not jump.
  const bool is_still = at.head<3>().isZero(0.0);
  Eigen::MatrixXd J(5, theta.size());
  for (int j = 0; j < theta.size(); ++j) {
    const double h = 1e-3 * std::max(std::sqrt(covariance(j, j)), 1e-9);
    Eigen::VectorXd plus = theta, minus = theta;
    plus[j] += h;
    if (!is_still) minus[j] -= h;
    Eigen::VectorXd d = Reported(plus) - Reported(minus);
    d[4] = std::remainder(d[4], kTwoPi);
    J.col(j) = d / (is_still ? h : 2 * h);
  }
  const Eigen::VectorXd sd = (J * covariance * J.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  std::vector<ReportedParameter> reported{
      {"amplitude_m", {at[0], at[1], at[2]}, {sd[0], sd[1], sd[2]}},
      {"frequency_hz", {at[3]}, {sd[3]}},
      {"phase_rad", {at[4]}, {std::min(sd[4], std::numbers::pi)}}};
  if (HasOvertone()) {
    reported.push_back(AsFitted("overtone_sine_m", kOvertoneSine, theta, covariance));
    reported.push_back(AsFitted("overtone_cosine_m", kOvertoneCosine, theta, covariance));
  }
  return reported;
}

Eigen::VectorXd PeriodicEffect::FromReported(const std::vector<std::vector<double>>& values) const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(FrequencyIndex() + 1);
  for (int i = 0; i < 3; ++i) {
    theta[kSine + i] = values.at(0).at(i) * std::cos(values.at(2).at(0));
    theta[kCosine + i] = values.at(0).at(i) * std::sin(values.at(2).at(0));
    if (!HasOvertone()) continue;
    theta[kOvertoneSine + i] = values.at(3).at(i);
    theta[kOvertoneCosine + i] = values.at(4).at(i);
  }
  theta[FrequencyIndex()] = values.at(1).at(0) - frequency_hz_;
  return theta;
}

std::optional<ScannedParameter> PeriodicEffect::Scanned(const SampleSet& samples) const {
  const double nyquist_hz = 0.5 / std::max(samples.period_s, 1e-6);
  const double highest_hz =
      std::max(oscillation_.lowest_hz, std::min(oscillation_.highest_hz, nyquist_hz));
  return ScannedParameter{.lowest = oscillation_.lowest_hz,
                          .highest = highest_hz,
                          .resolution = 1.0 / std::max(samples.Duration(), 1.0),
                          .correction = FrequencyIndex(),
                          .first_input = oscillation_.first_input,
                          .inputs = 3};
}

std::vector<int> PeriodicEffect::OwnParameters() const {
  std::vector<int> all(static_cast<std::size_t>(FrequencyIndex()) + 1);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

Eigen::VectorXd PeriodicEffect::TurnPhase(const Eigen::VectorXd& theta, double turn_rad) const {
  Eigen::VectorXd turned = theta;
  const auto turn = [&](int sine, int cosine, double angle) {
    const Eigen::Vector3d a = theta.segment<3>(sine), b = theta.segment<3>(cosine);
    turned.segment<3>(sine) = std::cos(angle) * a - std::sin(angle) * b;
    turned.segment<3>(cosine) = std::sin(angle) * a + std::cos(angle) * b;
  };
  turn(kSine, kCosine, turn_rad);
  if (HasOvertone()) turn(kOvertoneSine, kOvertoneCosine, 2.0 * turn_rad);
  return turned;
}

double PeriodicEffect::ScannedPhase(const Instant& now) const { return kTwoPi * TimeOf(now); }

}  // namespace flextip::diagnosis
