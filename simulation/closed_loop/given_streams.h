// Streams as the controller was given them: a recording of a sensor with a fault has the fault.
#pragma once

#include "recording/recording.h"
#include "simulation/closed_loop/closed_loop.h"
#include "simulation/closed_loop/loop_table.h"

namespace flextip::simulation {

/// Collects what a loop's controller is given of the streams that have faults in `setup`.
class GivenStreams {
 public:
  explicit GivenStreams(const LoopSetup& setup) : setup_(setup) {}

  void Add(const LoopCycle& cycle);
  /// Puts them in the place of the recording's own; samples that no recording can hold (no number,
  /// an older time) are left out.
  void PutInto(Recording& recording) const;

 private:
  bool HasFault(FaultStream stream) const;

  const LoopSetup& setup_;
  Series<WristMeasurement> wrist_;
  Series<TipMeasurement> tip_;
  Series<EmMeasurement> em0_;
  Series<StrainMeasurement> strain_;
  Series<LoadMeasurement> load_;
};

}  // namespace flextip::simulation
