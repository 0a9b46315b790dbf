// One fault of one sensor's samples.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>

#include "core/time_series.h"
#include "pipeline/sensor_readings.h"
#include "simulation/faults/fault.h"
#include "simulation/sensors/em_field.h"

namespace flextip::simulation {

/// Acts on the newest sample that a cycle is given. M: WristMeasurement, TipMeasurement,
/// EmMeasurement, StrainMeasurement or LoadMeasurement.
template <class M>
class SampleFault {
 public:
  /// Draws its direction from `seed`.
  SampleFault(const Fault& fault, std::uint64_t seed);

  /// Changes `sample`, the newest at `t_s`. Call it in every cycle.
  void Disturb(double t_s, std::optional<Sample<M>>& sample);

 private:
  void ActOnFigures(double t_s, Sample<M>& sample);
  void ActOnOrder(double t_s, Sample<M>& sample);
  void ActOnSensor(Sample<M>& sample);

  Fault fault_;
  std::mt19937_64 rng_;
  Eigen::VectorXd direction_;        // unit, of the fault
  Eigen::VectorXd other_direction_;  // unit, drawn anew for each sample
  double draw_ = 0.0;                // 0 to 1, drawn anew for each sample
  int count_ = 0;                    // samples since the fault's begin
  std::deque<Sample<M>> history_;    // as they came, the newest last
  std::optional<Sample<M>> held_;    // the first under the fault, or the last that was let through
  std::optional<EmField> field_;
};

}  // namespace flextip::simulation
