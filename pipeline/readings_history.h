// The sensors' recent past, for samples that come late.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <optional>

#include "pipeline/sensor_readings.h"

namespace flextip {

/// The readings of the last cycles, the newest always and the others four milliseconds or more
/// apart: a second or more. Fixed size.
class ReadingsHistory {
 public:
  /// Adds the readings of a cycle; those without a wrist, or not after the last ones, are left out.
  void Add(const SensorReadings& readings);

  /// Returns the sensors but the tip at `t_ns`, each interpolated between its own neighbouring
  /// samples; the last sample where there is none behind it yet. Empty before the oldest wrist.
  std::optional<SensorReadings> At(TimeNs t_ns) const;

  /// Returns the wrist at `t_ns`, as At, with the noise of its samples.
  std::optional<WristMeasurement> WristAt(TimeNs t_ns) const;

  /// Returns how far the wrist may have been from WristAt (m, in R): the standard deviation, along
  /// its way, of a step that it took at any moment between the two samples. Zero at a sample.
  Eigen::Vector3d WristDoubtAt(TimeNs t_ns) const;

  /// Returns the wrist's velocity (m/s, in R) about `t_ns`, over 40 ms; zero where it is not known.
  Eigen::Vector3d WristVelocityAt(TimeNs t_ns) const;

  void VisitState(StateText& state);

 private:
  static constexpr std::size_t kSize = 256;
  /// Returns the i-th readings, the oldest first.
  const SensorReadings& Of(std::size_t i) const { return ring_[(first_ + i) % kSize]; }
  template <class T>
  std::optional<Sample<T>> SampleAt(std::optional<Sample<T>> SensorReadings::*sensor,
                                    TimeNs t_ns) const;

  std::array<SensorReadings, kSize> ring_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace flextip
