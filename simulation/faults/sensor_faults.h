// The faults between the sensors and the controller.
#pragma once

#include <cstdint>
#include <vector>

#include "core/time_series.h"
#include "pipeline/sensor_readings.h"
#include "simulation/faults/fault.h"
#include "simulation/faults/sample_fault.h"

namespace flextip::simulation {

class SensorFaults {
 public:
  /// Takes those of `faults` that are of a sensor. Throws InputError where a stream cannot have its
  /// fault, or a figure is not finite.
  SensorFaults(const std::vector<Fault>& faults, std::uint64_t seed);

  /// Changes the newest readings of the cycle at `t_ns`, fault after fault. Call it in every cycle.
  void Disturb(TimeNs t_ns, SensorReadings& readings);

 private:
  std::vector<SampleFault<WristMeasurement>> wrist_;
  std::vector<SampleFault<TipMeasurement>> tip_;
  std::vector<SampleFault<EmMeasurement>> em0_;
  std::vector<SampleFault<StrainMeasurement>> strain_;
  std::vector<SampleFault<LoadMeasurement>> load_;
};

}  // namespace flextip::simulation
