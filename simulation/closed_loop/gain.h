// What a found model is worth where it is to be used: in closed loop.
#pragma once

#include <string>
#include <vector>

#include "control/controller.h"
#include "diagnosis/model/extended_model.h"
#include "recording/recording.h"

namespace flextip::simulation {

struct PathDeviation {
  double max_m = 0.0, rms_m = 0.0;
};

struct ControllerGain {
  ControllerKind kind = ControllerKind::kRodTrack;
  bool ran = false;  ///< false: the simulated instrument lost its equilibrium, or had none
  PathDeviation base, extended;
};

struct ClosedLoopGain {
  std::vector<ControllerGain> controllers;  ///< rod-calculate and rod-track
  /// One line that names the effects of the model that the simulation does not know; empty: none.
  std::string warning;
};

/// Runs rod-calculate and rod-track along a 10 mm square around the mean tip of `recording`, on the
/// plant with the effects of `model`, twice each: with the base model and with `model`. What the
/// simulation does not know of it is left out of both: whole effects, with a warning, and
/// port_motion's overtone. Sensors are
/// the recording's, with their stated noise; the tip is seen by its figures (by typical ones where
/// the recording has no vision0). The load is the mean of load0, where there is one. Takes some
/// seconds at most; the same input gives the same figures.
ClosedLoopGain MeasureClosedLoopGain(const Recording& recording,
                                     const diagnosis::ExtendedModel& model);

}  // namespace flextip::simulation
