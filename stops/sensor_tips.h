// Where each sensor by itself, with the wrist, has the tip; and all but one of them together.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <memory>
#include <optional>

#include "control/supervision/stops.h"
#include "estimation/instrument_model.h"
#include "estimation/shaft_estimator.h"
#include "pipeline/sensor_readings.h"

namespace flextip {

/// For looking back at a run; slower than a control cycle may be.
class SensorTips {
 public:
  /// `model`: the found one of the run, null for none.
  SensorTips(const EstimatorOptions& options, std::unique_ptr<InstrumentModel> model);

  /// Takes the readings of the next cycle. `f_tip_N`: the tip force as estimated in the run.
  void Take(TimeNs t_ns, const SensorReadings& readings, const Eigen::Vector3d& f_tip_N);

  /// Returns the sensors that the readings have, as bits.
  std::uint8_t Sensors() const;

  /// Returns the tip by that sensor and the wrist alone (m, in R). Empty where the sensor is not
  /// there, sees no place, or leaves the tip unknown by more than 5 mm.
  std::optional<Eigen::Vector3d> By(VotedSensor sensor);

  /// All sensors but one.
  struct Rest {
    std::optional<Eigen::Vector3d> p_RE;
    double chi2 = 0.0;
    bool fitted = false;
  };
  Rest Without(VotedSensor sensor);

 private:
  std::unique_ptr<InstrumentModel> model_;
  std::array<ShaftEstimator, kVotedSensors> alone_;
  std::array<ShaftEstimator, kVotedSensors> without_;
  std::optional<Measurements> z_;
};

}  // namespace flextip
