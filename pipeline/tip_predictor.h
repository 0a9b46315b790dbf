// Where wrist and shaft model expect the tip at a frame's time, before the frame has been looked
// at and while the tip hides.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "core/instrument.h"
#include "core/pose.h"
#include "core/state_text.h"
#include "core/time_series.h"
#include "estimation/shaft_estimator.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {

struct TipPredictorOptions {
  double force_prior_units = 0.5;  ///< sd of an unknown tip force, in EI / L^2
  double port_prior_m = kPortRegistration_m;
  /// The load's own wandering, a random walk: sd in EI / L^2 after one second. The wandering that
  /// the seen tips show takes over, but for a floor.
  double force_drift_units = 0.1, least_force_drift_units = 0.03;
  /// Sd of the tip's way by the model's error, over the way itself.
  double way_error = 0.05;
  /// Part of the stated position and direction errors that the rod's law does not tie together: it
  /// bends by more than the linearised covariance knows, and not exactly as the true shaft.
  double loose = 0.3;
  double direction_error_rad = 0.005;  ///< of a shaft that is not quite straight
};

/// Before the tip was seen: the tip by the other sensors (ShaftEstimator; the unloaded shaft with a
/// wide covariance where they do not see the load). Afterwards: the last seen pose carried on by
/// the model's motion since, with the port and the load that the seen tip told. Where the other
/// sensors see the load, their tip is joined by the covariances. The carried pose is sharp at first
/// and loses to load drift and distance.
class TipPredictor {
 public:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  /// Takes the port as registered, `p_RP`. All in R (m).
  TipPredictor(const Instrument& instrument, const Eigen::Vector3d& p_RP,
               const Eigen::Vector3d& gravity_m_s2, const TipPredictorOptions& options = {});

  /// Returns the tip expected at `t_ns`, when the sensors said `measured`, whose tip is not looked
  /// at. Empty where the wrist was not measured or the shaft has no equilibrium there.
  /// The roll about the shaft follows the wrist's quaternion without twist; where that was not
  /// measured, it stays where it was seen, and nothing is known of it before.
  std::optional<TipPrediction> Predict(TimeNs t_ns, const std::optional<Measurements>& measured);

  /// Visits the state that the frames so far have left. The solvers start afresh after writing and
  /// after reading: so both runs go on alike.
  void VisitState(StateText& state);

  /// Learns from a tip that was seen; `covariance` of (dw, dp) in R as in TipPrediction.
  void Seen(TimeNs t_ns, const std::optional<Measurements>& measured, const Pose& T_RE,
            const Matrix6& covariance);

 private:
  using Matrix6x9 = Eigen::Matrix<double, 6, 9>;
  /// The tip by the rod, and its derivative (dw, dp) by wrist, port and tip force.
  struct RodTip {
    Pose T_RE;
    Matrix6x9 J = Matrix6x9::Zero();
    bool has_roll = false;
    void VisitState(StateText& state) {
      state(T_RE);
      state(J);
      state(has_roll);
    }
  };
  struct Sight {
    TimeNs t_ns = 0;
    Pose T_RE;
    Matrix6 covariance = Matrix6::Zero();
    RodTip rod;  // by the model, with this port and load
    Eigen::Vector3d p_RP = Eigen::Vector3d::Zero(), f_tip_N = Eigen::Vector3d::Zero();
    Matrix6 parameters = Matrix6::Zero();  // covariance of port and tip force
    void VisitState(StateText& state);
  };
  struct Load {
    TimeNs t_ns = 0;
    Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
    void VisitState(StateText& state) {
      state(t_ns);
      state(f_tip_N);
    }
  };

  void LearnDrift();
  std::optional<RodTip> SolveRod(const Measurements& z, const Eigen::Vector3d& p_RP,
                                 const Eigen::Vector3d& f_tip_N);
  /// Predicts the tip from the sensors. `sees_load`: the sensors narrow the load down.
  std::optional<TipPrediction> FromSensors(const Measurements& z, bool& sees_load);
  std::optional<TipPrediction> FromSight(TimeNs t_ns, const Measurements& z);

  TipPredictorOptions options_;
  EstimatorOptions estimator_options_;
  ShaftEstimator blind_, seeing_;
  ShaftRod rod_;
  std::optional<Sight> sight_;
  std::optional<Load> earlier_;  // what the drift is learnt against
  double drift_variance_N2_s_;   // of each component, gained in a second
};

}  // namespace flextip
