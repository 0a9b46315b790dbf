// Rates, noises and places of a recording's streams.
#pragma once

#include "exchange/import_plan.h"
#include "exchange/streams/noise.h"
#include "recording/recording.h"

namespace flextip::exchange {

/// Gives every stream its settings: those told, else rates by the median of its steps and noises by
/// its values (MeasureNoise), which is said. Throws NotTold where the values tell nothing, and
/// InputError for a place off the shaft.
void TakeSettings(const ImportPlan& plan, Recording& recording, ImportLog& log);

/// One stream's settings as they are told or measured.
class Settings {
 public:
  Settings(std::string stream, const ImportPlan& plan, ImportLog& log);

  double Rate(const std::vector<TimeNs>& times);
  double Noise(const std::string& key, const std::vector<Eigen::VectorXd>& values);
  double Noise(const std::string& key, const std::vector<Eigen::Quaterniond>& rotations);
  double Or(const std::string& key, double fallback) const;
  std::string Text(const std::string& key, const std::string& fallback) const;
  /// Empty where it is not told.
  std::vector<double> List(const std::string& key) const;

 private:
  double Noted(const std::string& key, const std::optional<MeasuredNoise>& measured);
  NotTold MissingKey(const std::string& key) const;

  std::string stream_;
  ImportLog& log_;
  SensorSettings told_;
};

}  // namespace flextip::exchange
