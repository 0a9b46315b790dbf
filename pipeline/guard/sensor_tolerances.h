// What sensors may be off within specification, beside their noise.
#pragma once

#include <Eigen/Dense>

#include "control/supervision/supervisor_options.h"
#include "core/state_text.h"
#include "core/time_series.h"
#include "estimation/measurements.h"

namespace flextip {

/// Takes tolerances into the measurements that are held against each other. Tip and EM sensor are
/// off by about the same all the while: that is learnt from cycles in which all agree, so that a
/// sensor which moves away is seen before it has used up its tolerance. Fixed size, no allocation.
class ToleratedSensors {
 public:
  explicit ToleratedSensors(const SensorTolerances& tolerances);

  /// Returns `z` with the learnt offsets taken off and with noises that hold the tolerances.
  Measurements Widened(const Measurements& z) const;

  /// Takes the tip (R, m) of sensors that agree in `z`, as they came, at the time `t_ns`.
  void Learn(TimeNs t_ns, const Measurements& z, const Eigen::Vector3d& p_RE);

  void VisitState(StateText& state) {
    state(tip_);
    state(em_);
    state(learnt_ns_);
  }

 private:
  /// An offset of a sensor in R (m), never beyond three deviations.
  struct Offset {
    Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
    double tolerance_m = 0.0, variance_m2 = 0.0;
    double Doubt_m() const;
    void VisitState(StateText& state) {
      state(mean_m);
      state(variance_m2);
    }
    void Learn(const Eigen::Vector3d& seen_m, double noise_m, double dt_s);
  };

  SensorTolerances tolerances_;
  Offset tip_, em_;
  TimeNs learnt_ns_ = 0;
};

}  // namespace flextip
