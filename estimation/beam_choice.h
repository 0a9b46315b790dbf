// Which of the thesis's fits the sensors of an instant allow. Private to estimation.
#pragma once

#include "core/instrument.h"
#include "estimation/measurements.h"
#include "estimation/shaft_model.h"

namespace flextip {

/// The beam from the slopes at wrist and tip (an EM sensor's orientation or vision's direction)
/// where both and the tip's position are measured, else from the moments of two stations, else from
/// the force of `model`. A closed form whose port is not near the registered one is passed over.
/// kStraight where none of them shows bending.
BeamFit ChooseBeamFit(const Measurements& z, const Instrument& instrument, const ShaftModel& model,
                      bool use_positions);

}  // namespace flextip
