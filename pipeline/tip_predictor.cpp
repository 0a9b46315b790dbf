#include "pipeline/tip_predictor.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

using Matrix6 = TipPredictor::Matrix6;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kUnknownRoll_rad = 3.0;
constexpr double kRollModel_rad = 0.01;  // the shaft's own twist, and a collar's play

EstimatorOptions Options(EstimatorOptions estimator, const TipPredictorOptions& options) {
  estimator.force_prior_units = options.force_prior_units;
  estimator.estimate_tissue = false;
  return estimator;
}

double ForceUnit(const Instrument& instrument) {
  return instrument.bending_stiffness_Nm2 / (instrument.length_m * instrument.length_m);
}

void AddRoll(const Eigen::Vector3d& axis, double sd_rad, Matrix6& covariance) {
  covariance.topLeftCorner<3, 3>() += sd_rad * sd_rad * axis * axis.transpose();
}

/// Errors in any direction, a part of those stated.
void Loosen(const TipPredictorOptions& options, Matrix6& covariance) {
  const double square = options.loose * options.loose;
  const double turn = square * covariance.topLeftCorner<3, 3>().trace() +
                      options.direction_error_rad * options.direction_error_rad;
  const double shift = square * covariance.bottomRightCorner<3, 3>().trace();
  covariance.topLeftCorner<3, 3>() += turn * Eigen::Matrix3d::Identity();
  covariance.bottomRightCorner<3, 3>() += shift * Eigen::Matrix3d::Identity();
}

/// What two independent predictions say together.
TipPrediction Join(const TipPrediction& a, const TipPrediction& b) {
  Vector6 difference;
  difference << LogRotation(b.T_RE.R * a.T_RE.R.transpose()), b.T_RE.p - a.T_RE.p;
  const Matrix6 sum = a.covariance + b.covariance;
  const Matrix6 gain = Ldlt(sum).Solve(a.covariance).transpose();
  const Vector6 step = gain * difference;
  TipPrediction joined;
  joined.T_RE = {ExpRotation(step.head<3>()) * a.T_RE.R, a.T_RE.p + step.tail<3>()};
  const Matrix6 covariance = a.covariance - gain * a.covariance;
  joined.covariance = 0.5 * (covariance + covariance.transpose());
  return joined;
}

}  // namespace

TipPredictor::TipPredictor(const Instrument& instrument, const Eigen::Vector3d& p_RP,
                           const Eigen::Vector3d& gravity_m_s2, const TipPredictorOptions& options)
    : options_(options),
      estimator_options_(Options(
          EstimatorOptionsFor(instrument, p_RP, gravity_m_s2, options.port_prior_m), options)),
      blind_(estimator_options_),
      seeing_(estimator_options_),
      drift_variance_N2_s_(std::pow(options.force_drift_units * ForceUnit(instrument), 2)) {}

std::optional<TipPredictor::RodTip> TipPredictor::SolveRod(const Measurements& z,
                                                           const Eigen::Vector3d& p_RP,
                                                           const Eigen::Vector3d& f_tip_N) {
  ShaftModel model;
  model.instrument = estimator_options_.instrument;
  model.p_RP = p_RP;
  model.weight_N_m = model.instrument.mass_per_length_kg_m * estimator_options_.gravity_m_s2;
  model.f_tip_N = f_tip_N;
  const ShaftRodState rod = rod_.Solve(RodOf(model, z.p_RW));
  if (!rod.IsUsable()) return {};
  RodTip tip;
  tip.has_roll = z.R_RW.has_value();
  // Each part of the rod bends in a plane of its own, but for its weight: no twist by steps.
  const Eigen::Matrix3d R_RW = z.R_RW.value_or(Eigen::Matrix3d::Identity());
  tip.T_RE.R = RotationWithoutTwist(rod.t_port, rod.end.t) *
               RotationWithoutTwist(rod.wrist.t, rod.t_port) *
               RotationWithoutTwist(R_RW.col(0), rod.wrist.t) * R_RW;
  tip.T_RE.p = rod.p_RE;
  tip.J << Skew(rod.end.t) * rod.end.dt, rod.dp_RE;
  return tip;
}

std::optional<TipPrediction> TipPredictor::FromSensors(const Measurements& z, bool& sees_load) {
  const ShaftEstimate estimate = blind_.Update(z);
  sees_load = estimate.status == EstimateStatus::kOk;
  const bool fits =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  const auto tip = SolveRod(z, estimate.model.p_RP, estimate.model.f_tip_N);
  if (!tip) return {};
  Matrix9d parameters = estimate.covariance;
  if (!fits) {
    Eigen::Matrix<double, 9, 1> sd;
    sd << Eigen::Vector3d::Constant(z.wrist_position_noise_m),
        Eigen::Vector3d::Constant(options_.port_prior_m),
        Eigen::Vector3d::Constant(options_.force_prior_units *
                                  ForceUnit(estimator_options_.instrument));
    parameters = sd.cwiseAbs2().asDiagonal();
  }
  TipPrediction prediction{tip->T_RE, tip->J * parameters * tip->J.transpose()};
  Loosen(options_, prediction.covariance);
  AddRoll(
      tip->T_RE.R.col(0),
      tip->has_roll ? std::hypot(z.wrist_orientation_noise_rad, kRollModel_rad) : kUnknownRoll_rad,
      prediction.covariance);
  return prediction;
}

void TipPredictor::Seen(TimeNs t_ns, const std::optional<Measurements>& measured, const Pose& T_RE,
                        const Matrix6& covariance) {
  sight_.reset();
  if (!measured) return;
  Measurements z = *measured;
  TipObservation tip;
  tip.status = TipStatus::kOk;
  tip.p_RE = T_RE.p;
  tip.covariance_m2 = covariance.bottomRightCorner<3, 3>();
  tip.d_RE = T_RE.R.col(0);
  const Eigen::Matrix3d turn = Skew(T_RE.R.col(0));
  z.tip_direction_noise_rad =
      std::sqrt(0.5 * (turn * covariance.topLeftCorner<3, 3>() * turn.transpose()).trace());
  z.tip = tip;
  const ShaftEstimate estimate = seeing_.Update(z);
  if (estimate.status == EstimateStatus::kNotConverged ||
      estimate.status == EstimateStatus::kBadInput) {
    return;
  }
  const auto rod = SolveRod(z, estimate.model.p_RP, estimate.model.f_tip_N);
  if (!rod) return;
  sight_ = Sight{t_ns,
                 T_RE,
                 covariance,
                 *rod,
                 estimate.model.p_RP,
                 estimate.model.f_tip_N,
                 estimate.covariance.bottomRightCorner<6, 6>()};
  LearnDrift();
}

void TipPredictor::Sight::VisitState(StateText& state) {
  state(t_ns);
  state(T_RE);
  state(covariance);
  state(rod);
  state(p_RP);
  state(f_tip_N);
  state(parameters);
}

void TipPredictor::VisitState(StateText& state) {
  blind_.Reset();
  seeing_.Reset();
  rod_.Reset();
  state(sight_);
  state(earlier_);
  state(drift_variance_N2_s_);
}

// How far the load has wandered in the last third of a second, by what that does to the tip: the
// force along the shaft, which hardly moves it, is hardly known.
void TipPredictor::LearnDrift() {
  constexpr double kStep_s = 0.3, kMemory = 0.8;
  const double seconds = earlier_ ? 1e-9 * static_cast<double>(sight_->t_ns - earlier_->t_ns) : 0.0;
  if (earlier_ && seconds >= 0.0 && seconds < kStep_s) return;
  if (earlier_ && seconds > 0.0 && seconds < 3 * kStep_s) {
    const Eigen::Matrix3d J = sight_->rod.J.bottomRightCorner<3, 3>();
    const double square = (J * (sight_->f_tip_N - earlier_->f_tip_N)).squaredNorm();
    const double variance_s = square / std::max(J.squaredNorm(), 1e-18) / seconds;
    drift_variance_N2_s_ = kMemory * drift_variance_N2_s_ + (1 - kMemory) * variance_s;
  }
  earlier_ = Load{sight_->t_ns, sight_->f_tip_N};
}

std::optional<TipPrediction> TipPredictor::FromSight(TimeNs t_ns, const Measurements& z) {
  const auto now = SolveRod(z, sight_->p_RP, sight_->f_tip_N);
  if (!now) return {};
  const RodTip& then = sight_->rod;
  const bool has_roll = now->has_roll && then.has_roll;
  const Eigen::Matrix3d turn = has_roll
                                   ? Eigen::Matrix3d(now->T_RE.R * then.T_RE.R.transpose())
                                   : RotationWithoutTwist(then.T_RE.R.col(0), now->T_RE.R.col(0));
  const Eigen::Vector3d way = now->T_RE.p - then.T_RE.p;
  TipPrediction prediction{{turn * sight_->T_RE.R, sight_->T_RE.p + way}, sight_->covariance};
  Matrix6& P = prediction.covariance;
  // What is not known of port and load matters as far as its effect has changed; the wrist's noise
  // is another one each time.
  const Eigen::Matrix<double, 6, 6> changed = (now->J - then.J).rightCols<6>();
  P += changed * sight_->parameters * changed.transpose();
  const double wrist_variance = z.wrist_position_noise_m * z.wrist_position_noise_m;
  for (const RodTip* tip : {&then, &*now}) {
    P += wrist_variance * tip->J.leftCols<3>() * tip->J.leftCols<3>().transpose();
  }
  const double seconds = 1e-9 * std::abs(static_cast<double>(t_ns - sight_->t_ns));
  const double least_N =
      options_.least_force_drift_units * ForceUnit(estimator_options_.instrument);
  const double drift_N2 = std::max(drift_variance_N2_s_, least_N * least_N) * seconds;
  P += drift_N2 * now->J.rightCols<3>() * now->J.rightCols<3>().transpose();
  const double turned = options_.way_error * LogRotation(turn).norm();
  const double gone = options_.way_error * way.norm();
  P.topLeftCorner<3, 3>() += turned * turned * Eigen::Matrix3d::Identity();
  P.bottomRightCorner<3, 3>() += gone * gone * Eigen::Matrix3d::Identity();
  AddRoll(prediction.T_RE.R.col(0),
          has_roll ? M_SQRT2 * z.wrist_orientation_noise_rad : kUnknownRoll_rad * seconds, P);
  return prediction;
}

std::optional<TipPrediction> TipPredictor::Predict(TimeNs t_ns,
                                                   const std::optional<Measurements>& measured) {
  if (!measured) return {};
  Measurements z = *measured;
  z.tip.reset();
  bool sees_load = false;
  const auto by_sensors = FromSensors(z, sees_load);
  const auto by_sight = sight_ ? FromSight(t_ns, z) : std::nullopt;
  if (by_sight && by_sensors && sees_load) return Join(*by_sight, *by_sensors);
  return by_sight ? by_sight : by_sensors;
}

}  // namespace flextip
