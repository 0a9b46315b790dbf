#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// A pulley off its centre: the measured wrist is off along the line to the port by a sine of the
/// distance between both. Fitted as sine and cosine amplitude (m) and a correction of the waves per
/// metre, which are scanned.
class EncoderEccentricity : public Effect {
 public:
  std::string Name() const override { return "encoder_eccentricity"; }
  std::string Summary() const override { return "a pulley of the insertion is off its centre"; }
  bool Applies(const SampleSet& samples) const override {
    return Travel_m(samples) > kLeastTravel_m;
  }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    const double tolerance = ToleranceOf(samples, Name(), "amplitude_m", 0.00005)[0];
    auto all = WithTypical({tolerance, tolerance}, 0.0005);
    const double resolution = kResolution / std::max(Travel_m(samples), kLeastTravel_m);
    all.push_back({resolution, resolution, false});
    return all;
  }
  void Apply(const double* theta, const Instant& now, EffectMemory&,
             InputChange& change) const override {
    const DiagnosisSample& sample = now.samples.samples[now.k];
    const Eigen::Vector3d to_port = now.samples.p_RP - sample.p_RW;
    const double measured_m = to_port.norm(), k = kTwoPi * (waves_1_m_ + theta[kWaves]);
    // The wave is of the true distance: measured plus what the reading is off.
    double off_m = 0.0, slope = 0.0, sine = 0.0, cosine = 0.0;
    for (int i = 0; i < kIterations; ++i) {
      sine = std::sin(k * (measured_m + off_m));
      cosine = std::cos(k * (measured_m + off_m));
      slope = std::min(kMostSlope, k * (theta[kSine] * cosine - theta[kCosine] * sine));
      const double miss_m = theta[kSine] * sine + theta[kCosine] * cosine - off_m;
      off_m += miss_m / (1.0 - slope);
    }
    const double by_waves =
        kTwoPi * (measured_m + off_m) * (theta[kSine] * cosine - theta[kCosine] * sine);
    const Eigen::Vector3d along = to_port / measured_m;
    for (int i = 0; i < 3; ++i) {
      const int input = sample_input::kWrist + i;
      const double factor = -along[i] / (1.0 - slope);
      change.Add(input, -along[i] * off_m);
      change.Derivative(kSine, input, factor * sine);
      change.Derivative(kCosine, input, factor * cosine);
      change.Derivative(kWaves, input, factor * by_waves);
    }
  }
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override {
    const double amplitude_m = theta.head<2>().norm(), waves = waves_1_m_ + theta[kWaves];
    double phase = std::atan2(theta[kCosine], theta[kSine]);
    if (phase < 0.0) phase += kTwoPi;
    // Where there is no amplitude, its deviation is that of both parts.
    const Eigen::Vector2d part =
        amplitude_m > 0.0 ? Eigen::Vector2d(theta.head<2>() / amplitude_m) : Eigen::Vector2d(1, 0);
    const Eigen::Vector2d across(-part.y(), part.x());
    const Eigen::Matrix2d C = covariance.topLeftCorner<2, 2>();
    const double across_m = std::sqrt(across.dot(C * across));
    const double phase_sd =
        amplitude_m > 0.0 ? std::min(across_m / amplitude_m, std::numbers::pi) : std::numbers::pi;
    return {{"amplitude_m", {amplitude_m}, {std::sqrt(part.dot(C * part))}},
            {"wavelength_m", {1.0 / waves}, {std::sqrt(covariance(2, 2)) / (waves * waves)}},
            {"phase_rad", {phase}, {phase_sd}}};
  }
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override {
    const double amplitude_m = values.at(0).at(0), phase = values.at(2).at(0);
    return Eigen::Vector3d(amplitude_m * std::cos(phase), amplitude_m * std::sin(phase),
                           1.0 / values.at(1).at(0) - waves_1_m_);
  }
  std::optional<ScannedParameter> Scanned(const SampleSet& samples) const override {
    return ScannedParameter{.lowest = kLongest,
                            .highest = kShortest,
                            .resolution = 1.0 / std::max(Travel_m(samples), kLeastTravel_m),
                            .correction = kWaves,
                            .first_input = sample_input::kWrist,
                            .inputs = 3};
  }
  double ScannedPhase(const Instant& now) const override {
    return kTwoPi * (now.samples.p_RP - now.samples.samples[now.k].p_RW).norm();
  }
  double ScanCentre() const override { return waves_1_m_; }
  void SetScanCentre(double waves_1_m) override { waves_1_m_ = waves_1_m; }

 private:
  static constexpr int kSine = 0, kCosine = 1, kWaves = 2, kIterations = 8;
  static constexpr double kMostSlope = 0.7;
  static constexpr double kLeastTravel_m = 0.01;
  static constexpr double kResolution = 0.3;  // of the waves per metre, over the travel's inverse
  static constexpr double kLongest = 8.0, kShortest = 150.0;  // waves per metre

  /// How far the distance from wrist to port goes.
  static double Travel_m(const SampleSet& samples) {
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const DiagnosisSample& sample : samples.samples) {
      least = std::min(least, (samples.p_RP - sample.p_RW).norm());
      most = std::max(most, (samples.p_RP - sample.p_RW).norm());
    }
    return samples.samples.empty() ? 0.0 : most - least;
  }

  double waves_1_m_ = 50.0;
};

}  // namespace

std::unique_ptr<Effect> MakeEncoderEccentricity() {
  return std::make_unique<EncoderEccentricity>();
}

}  // namespace flextip::diagnosis
