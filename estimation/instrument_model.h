// A found model as estimation and the closed loop use it. Implemented where the model is known
// (diagnosis/), so that neither needs to know the effects.
#pragma once

#include <Eigen/Dense>

#include "core/state_text.h"
#include "core/time_series.h"
#include "estimation/measurements.h"
#include "estimation/shaft_change.h"

namespace flextip {

/// The instrument and its sensors at each instant in turn: friction and play remember earlier
/// motion.
class InstrumentModel {
 public:
  virtual ~InstrumentModel() = default;

  /// Moves on to `t_ns` (not before the last one). `f_tip_N` is the tip force last known.
  virtual void Advance(TimeNs t_ns, const Measurements& measured,
                       const Eigen::Vector3d& f_tip_N) = 0;
  virtual const ShaftChange& Shaft() const = 0;
  /// Returns the readings of sensors without their own effects. Latencies stay.
  virtual Measurements Correct(const Measurements& measured) const = 0;
  /// Returns the standard deviation (m) of the instrument's length: how far along the shaft the tip
  /// may be from where the estimate has it.
  virtual double LengthSd() const { return 0.0; }
  /// Visits what it remembers.
  virtual void VisitState(StateText& state) = 0;

 protected:
  InstrumentModel() = default;
  InstrumentModel(const InstrumentModel&) = default;
  InstrumentModel& operator=(const InstrumentModel&) = default;
};

}  // namespace flextip
