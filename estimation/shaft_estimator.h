// From any set of sensors at one instant to the instrument's load, port and shape.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>

#include "core/instrument.h"
#include "estimation/measurements.h"
#include "estimation/shaft_change.h"
#include "estimation/shaft_model.h"
#include "estimation/shaft_rod.h"
#include "estimation/tissue_secants.h"

namespace flextip {

/// How well a port is registered where nobody says: standard deviation per axis (m).
inline constexpr double kPortRegistration_m = 0.0003;

struct EstimatorOptions {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();  ///< the port as registered
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  double port_prior_m = kPortRegistration_m;  ///< standard deviation per axis of p_RP
  double force_prior_units = 4.0;  ///< standard deviation of the tip force in units of EI / L^2
  /// False: only the measurements of a system without tip tracking (orientations, strain, load, no
  /// tip or EM position), for the controllers that calculate the tip.
  bool use_positions = true;
  bool estimate_tissue = true;   ///< df_tip/dp_tip from how the load changed with the tip
  bool compare_sensors = false;  ///< hold each sensor against all others
  bool fit_beam = true;          ///< the thesis's beam, too, for the controllers that use it
};

/// Returns the options of an instrument whose port was registered at `p_RP`; all in R. Everything
/// that makes an estimator begins here.
EstimatorOptions EstimatorOptionsFor(const Instrument& instrument, const Eigen::Vector3d& p_RP,
                                     const Eigen::Vector3d& gravity_m_s2,
                                     double port_prior_m = kPortRegistration_m);

enum class EstimateStatus : std::uint8_t {
  kOk,
  kUnobservable,  ///< the sensors say nothing of the load across the shaft, or too little for the
                  ///< tip to be better known than the unloaded shaft's: taken as unloaded
  kNotConverged,  ///< no rod fits: the straight shaft is handed on
  kBadInput,      ///< a measurement, the change or the options are not plausible
};
const char* Name(EstimateStatus status);

using Matrix9d = Eigen::Matrix<double, 9, 9>;

struct ShaftEstimate {
  EstimateStatus status = EstimateStatus::kBadInput;
  ShaftModel model;                                ///< for the controllers
  Matrix9d covariance = Matrix9d::Zero();          ///< of wrist, port, tip force
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();  ///< the tip by the fitted rod
  Eigen::Matrix3d p_RE_covariance_m2 = Eigen::Matrix3d::Zero();
  Eigen::Vector3d d_RE = Eigen::Vector3d::UnitX();  ///< its direction, unit
  double s_port_m = 0.0;                            ///< inserted from the wrist
  double chi2 = 0.0;                                ///< of the measurements and priors
  int measurements = 0;                             ///< scalar measurements used
  SensorMisfits misfits;                            ///< where EstimatorOptions asks for them
  bool from_all_starts = false;                     ///< another start would not do better
};

class RodFit;
using RodParameters = Eigen::Matrix<double, 9, 1>;

/// Fits the exact rod (unknowns: wrist, port, tip force; priors: encoder noise, registration, a
/// wide one on the force) by Levenberg-Marquardt with analytic derivatives, and the thesis's beam
/// by the closed forms where their sensors are present, else from the fitted force. Starts from the
/// last estimate; a call allocates nothing.
class ShaftEstimator {
 public:
  explicit ShaftEstimator(const EstimatorOptions& options);

  /// Estimates from the measurements of an instant. `change`: the instrument's difference from its
  /// data at this instant, where a model was found.
  ShaftEstimate Update(const Measurements& measurements, const ShaftChange& change = {});

  /// Sets the port's shift from its registered place (m, in R) from now on, in place of
  /// `port_prior_m`, with a positive definite covariance.
  void SetPort(const Eigen::Vector3d& shift_m, const Eigen::Matrix3d& covariance_m2);

  /// Forgets the past: warm start, tissue and the shift of SetPort.
  void Reset();

  void VisitState(StateText& state) {
    state(solver_);
    state(last_);
    state(port_shift_m_);
    state(port_whitening_);
    state(tissue_);
  }

 private:
  /// Where the last fit ended.
  struct Last {
    Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();     // as measured
    Eigen::Vector3d wrist_m = Eigen::Vector3d::Zero();  // less the prior's mean
    Eigen::Vector3d port_m = Eigen::Vector3d::Zero();   // less the prior's mean
    Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
    double misfit = 0.0;  // chi2 a measurement; 0: there is none
    void VisitState(StateText& state) {
      state(p_RW);
      state(wrist_m);
      state(port_m);
      state(force_N);
      state(misfit);
    }
  };
  bool FitFromAnyStart(RodFit& fit, RodParameters& x, ShaftEstimate& estimate);
  bool Fit(RodFit& fit, RodParameters& x, ShaftEstimate& estimate);
  void Describe(const RodFit& fit, const RodParameters& x, ShaftEstimate& estimate);
  /// Returns whether the load bends the shaft by more than the doubt in the tip, so that the load
  /// improves the tip.
  static bool StandsOut(const RodFit& fit, const ShaftRodState& rod, const ShaftEstimate& estimate);
  void FillModel(const RodFit& fit, const RodParameters& x, const Measurements& z,
                 ShaftEstimate& estimate);

  EstimatorOptions options_;
  ShaftRod solver_;
  Last last_;
  Eigen::Vector3d port_shift_m_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Matrix3d> port_whitening_;
  TissueSecants tissue_;
};

}  // namespace flextip
