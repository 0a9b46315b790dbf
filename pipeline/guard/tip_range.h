// Where wrist and shaft can have the tip at all, whatever the pictures say.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "core/instrument.h"
#include "core/state_text.h"
#include "core/time_series.h"
#include "estimation/measurements.h"
#include "pipeline/tip_predictor.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {

struct TipRangeOptions {
  /// Sd of a tip force that no sensor sees, in EI / L^2: six of them bend the shaft as far as it
  /// goes.
  double force_units = 1.0;
  /// Sd of what files state and nobody has checked: the camera's pose, the port, the shaft's
  /// straightness.
  double registration_m = 0.0007, registration_rad = 0.005;
};

/// The tip by wrist, port and the sensors beside the pictures, with a covariance of all that may be
/// wrong with them: a tip that lies outside is not this shaft's, or not of this instant.
class TipRange {
 public:
  /// Takes the port as registered, `p_RP`. All in R (m).
  TipRange(const Instrument& instrument, const Eigen::Vector3d& p_RP,
           const Eigen::Vector3d& gravity_m_s2, const TipRangeOptions& options = {});

  /// Returns the tip when the sensors said `measured`, whose tip is not looked at. Empty where the
  /// wrist was not measured or the shaft has no equilibrium there.
  std::optional<TipPrediction> At(TimeNs t_ns, const std::optional<Measurements>& measured);

  /// Visits the state: the solvers start afresh after writing and after reading.
  void VisitState(StateText& state) { by_sensors_.VisitState(state); }

 private:
  TipRangeOptions options_;
  TipPredictor by_sensors_;  // is never told what was seen
};

}  // namespace flextip
