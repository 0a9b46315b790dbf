// Breathing: the port moves to and fro at one frequency, with a first overtone since breath is no
// pure sine.
#pragma once

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

class PortMotion : public Effect {
 public:
  std::string Name() const override { return "port_motion"; }
  std::string Summary() const override { return "breathing moves the port"; }
  bool Applies(const SampleSet& samples) const override;
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override;
  void Apply(const double* theta, const Moment& now, EffectMemory& memory,
             InputChange& change) const override;
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override;
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override;

  /// The frequency around which the effect is fitted; the screen finds it.
  void SetFrequency(double frequency_hz) { frequency_hz_ = frequency_hz; }
  double Frequency() const { return frequency_hz_; }

 private:
  static constexpr double kOvertone = 0.2;  ///< its amplitude against the fundamental's
  double frequency_hz_ = 0.25;
};

}  // namespace flextip::diagnosis
