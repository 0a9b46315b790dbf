// An effect that swings three inputs at one frequency: breathing moves the port, a motor disturbs
// a tracker.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

/// The properties that tell one periodic effect from another.
struct Oscillation {
  int first_input = 0;     ///< of the three inputs that swing, see sample_input
  double tolerance = 0.0;  ///< of the amplitude, unless the recording states its own
  double typical = 0.0;    ///< amplitude
  double lowest_hz = 0.0, highest_hz = 0.0;  ///< range of the search
  double start_hz = 0.0;                     ///< where the search has not been yet
  double overtone = 0.0;  ///< amplitude of the first overtone over the fundamental's; 0: none
};

/// Reports `amplitude_m` (3), `frequency_hz`, `phase_rad` and, where there is an overtone,
/// `overtone_sine_m` (3) and `overtone_cosine_m` (3). All axes swing in one phase as reported; the
/// fit leaves each its own. Derived classes say when the effect applies.
class PeriodicEffect : public Effect {
 public:
  std::string Name() const override { return name_; }
  std::string Summary() const override { return summary_; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override;
  void Apply(const double* theta, const Instant& now, EffectMemory& memory,
             InputChange& change) const override;
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override;
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override;
  std::optional<ScannedParameter> Scanned(const SampleSet& samples) const override;
  double ScannedPhase(const Instant& now) const override;
  double ScanCentre() const override { return frequency_hz_; }
  void SetScanCentre(double frequency_hz) override { frequency_hz_ = frequency_hz; }
  /// All: breath and motor are as they are on that day.
  std::vector<int> OwnParameters() const override;
  bool HasPhase() const override { return true; }
  Eigen::VectorXd TurnPhase(const Eigen::VectorXd& theta, double turn_rad) const override;

 protected:
  PeriodicEffect(std::string name, std::string summary, const Oscillation& oscillation);

 private:
  bool HasOvertone() const { return oscillation_.overtone > 0.0; }
  double TimeOf(const Instant& now) const;
  int FrequencyIndex() const { return HasOvertone() ? 12 : 6; }
  Eigen::VectorXd Reported(const Eigen::VectorXd& theta) const;

  std::string name_, summary_;
  Oscillation oscillation_;
  double frequency_hz_;
};

}  // namespace flextip::diagnosis
