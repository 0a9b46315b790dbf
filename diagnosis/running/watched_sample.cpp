#include "diagnosis/running/watched_sample.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip::diagnosis::running {
namespace {

using namespace sample_input;

// Of a force that no sensor sees, in units of EI / L^2: across the shaft as in a diagnosis, along
// it as the estimator has it.
constexpr double kForceAcross = 20.0, kForceAlong = 4.0;
// By how much the force differs from that of the moment before, in the same units; and the part of
// it along the shaft that is forgotten where no load cell says it.
constexpr double kStepAcross = 0.5, kStepAlong = 0.1, kForceDecay = 0.03;
constexpr double kNewForce = 0.25, kFarthestStep = 2.0;
// Within tolerance: the port's motion, its friction, the width of the wrist's play from its middle,
// and a part of each row's noise.
constexpr double kBreathing_m = 1e-4, kFriction = 0.03, kPlay_m = 5e-5, kModelError = 0.2;
// How long such an error stays about the same: it is no chance that another sample shows it, too.
constexpr double kStays_s = 1.5, kShortest_s = 0.02;
constexpr double kLeastNoise = 1e-9;
constexpr int kForce = rod_input::kForce;

double Seconds(TimeNs t_ns) { return 1e-9 * static_cast<double>(t_ns); }

bool HasTip(const Measurements& z) { return z.tip && z.tip->status != TipStatus::kLost; }

}  // namespace

SampleWatch::SampleWatch(const Recording& base) {
  set_.instrument = base.instrument;
  set_.p_RP = base.p_RP;
  set_.gravity_m_s2 = base.gravity_m_s2;
  set_.tolerances = base.tolerances;
  set_.samples.resize(1);
  const double length_m = base.instrument.length_m;
  force_unit_N_ = base.instrument.bending_stiffness_Nm2 / (length_m * length_m);
}

void SampleWatch::SetSample(const WatchedMoment& moment, const std::array<bool, 4>& sampled) {
  const Measurements& z = moment.measurements;
  DiagnosisSample& now = set_.samples[0];
  now.present.reset();
  const auto has = [&now](int first, int rows) {
    for (int i = first; i < first + rows; ++i) now.present.set(static_cast<std::size_t>(i));
  };
  if (start_ns_ == 0) start_ns_ = moment.t_ns;
  now.t_s = Seconds(moment.t_ns - start_ns_);
  now.p_RW = z.p_RW;
  // As in sample_set: without a measured orientation, R's axes turned without twist to the port.
  const Eigen::Vector3d to_port = (set_.p_RP - z.p_RW).normalized();
  now.y_wrist = z.R_RW ? Eigen::Vector3d(z.R_RW->col(1))
                       : Eigen::Vector3d(RotationWithoutTwist(Eigen::Vector3d::UnitX(), to_port) *
                                         Eigen::Vector3d::UnitY());
  if (z.R_RW) {
    now.d_wrist = z.R_RW->col(0);
    has(row::kWristDirection, 2);
  }
  set_.has_em = z.em.has_value();
  if (z.em) {
    set_.em_from_tip_m = z.em->distance_from_tip_m;
    now.p_RS = z.em->T_RS.p;
    now.d_em = z.em->T_RS.R.col(0);
    if (sampled[0]) has(row::kEmPosition, 5);  // and its direction
  }
  if (z.port_direction && sampled[1]) {
    now.d_port = *z.port_direction;
    has(row::kPortDirection, 2);
  }
  set_.has_strain = z.strain.has_value();
  if (z.strain) {
    for (std::size_t i = 0; i < 2; ++i)
      set_.strain_from_wrist_m[i] = z.strain->station_from_wrist_m[i];
    now.moments_Nm = z.strain->moments_Nm;
    if (sampled[2]) has(row::kStrain, 4);
  }
  if (HasTip(z)) {
    now.p_RE = z.tip->p_RE;
    has(row::kTipPosition, 3);
    if (z.tip->d_RE) {
      now.d_tip = *z.tip->d_RE;
      has(row::kTipDirection, 2);
    }
  }
  has_load_ = z.load.has_value() && sampled[3];
  if (knows_place_) return;
  // Turns of a sensor's frame are about where the instrument works.
  if (!HasTip(z) && !z.em) return;
  set_.centre = HasTip(z) ? z.tip->p_RE : z.em->T_RS.p;
  knows_place_ = true;
}

/// The found model's change of the shaft; its sensors are corrected already.
void SampleWatch::SetInputs(const ShaftChange& change) {
  inputs_.setZero();
  inputs_[kStiffness] = std::log(change.stiffness_scale);
  inputs_[kLength] = change.length_delta_m;
  inputs_.segment<3>(kWeight) = change.weight_N_m;
  inputs_.segment<3>(kWrist) = change.wrist_shift_m;
  inputs_.segment<3>(kPort) = change.port_shift_m;
  inputs_[kTipCompliance] = change.tip_compliance_m_N;
  inputs_.segment<2>(kCurvature) = change.effects.curvature_1_m;
  inputs_[kPortCompliance] = change.effects.port_compliance_m_N;
  inputs_[kWristCompliance] = change.effects.wrist_compliance_m_N;
  inputs_.segment<3>(kPortCouple) = change.effects.port_couple_Nm;
  inputs_[kPortFriction] = change.effects.port_friction;
  inputs_.segment<3>(kInside) = change.effects.q_inside_N_m;
}

/// From the moments before this one, lest a reading's noise looks like a motion.
void SampleWatch::FindRate(double t_s, const Geometry& at) {
  rate_.setZero();
  const Timed& first = last_[0];
  const Timed& oldest = last_.back();
  constexpr double kLongest_s = 0.5;
  if (known_ == static_cast<int>(last_.size()) && t_s - oldest.t_s < kLongest_s)
    rate_ = (first.at - oldest.at) / (first.t_s - oldest.t_s);
  for (std::size_t i = last_.size() - 1; i > 0; --i) last_[i] = last_[i - 1];
  last_[0] = {t_s, at};
  known_ = std::min(known_ + 1, static_cast<int>(last_.size()));
}

SampleWatch::Matrix SampleWatch::OwnCovariance(const Measurements& z) const {
  Matrix C = Matrix::Identity();  // of rows that are not there
  const auto fill = [&](int first, int rows, double sd) {
    for (int r = first; r < first + rows; ++r) {
      const bool is_there = r >= kLoadRow || set_.samples[0].present[static_cast<std::size_t>(r)];
      if (is_there) C(r, r) = std::max(sd, kLeastNoise) * std::max(sd, kLeastNoise);
    }
  };
  fill(row::kWristDirection, 2, z.wrist_orientation_noise_rad);
  if (z.em) {
    fill(row::kEmPosition, 3, z.em->position_noise_m);
    fill(row::kEmDirection, 2, z.em->orientation_noise_rad);
  }
  fill(row::kPortDirection, 2, z.port_direction_noise_rad);
  if (z.strain) fill(row::kStrain, 4, z.strain->moment_noise_Nm);
  if (set_.samples[0].Has(row::kTipPosition))
    C.block<3, 3>(row::kTipPosition, row::kTipPosition) =
        z.tip->covariance_m2 + kLeastNoise * kLeastNoise * Eigen::Matrix3d::Identity();
  fill(row::kTipDirection, 2, z.tip_direction_noise_rad);
  if (has_load_) fill(kLoadRow, 3, z.load->force_noise_N);
  return C;
}

/// The likeliest difference of the force from the one expected, of which `root` is a square root of
/// the covariance.
Eigen::Vector3d SampleWatch::ForceStep(const Matrix& known, const ByThree& by_force,
                                       const Eigen::Matrix3d& root,
                                       const Eigen::Matrix<double, kRows, 1>& e) {
  const ByThree by_step = by_force * root;
  Matrix C = known;
  C.noalias() += by_step * by_step.transpose();
  const Llt<kRows> factor(C);
  if (!factor.Succeeded()) return Eigen::Vector3d::Constant(std::nan(""));
  return root * (factor.SolveL(by_step).transpose() * factor.SolveL(e));
}

/// Derivatives are taken at the force of the moments before: at the moment's own, its noise would
/// look like something explained. Along the shaft, where little is known of it, it follows slowly
/// and goes back to none. Returns whether the force is near enough to where it was expected.
bool SampleWatch::FollowForce(const Eigen::Vector3d& along, const Eigen::Vector3d& step_N) {
  if (!step_N.allFinite()) return false;
  const Eigen::Vector3d across_N = step_N - along.dot(step_N) * along;
  const bool near = across_N.norm() < kNewForce * force_unit_N_;
  const double farthest_N = kFarthestStep * force_unit_N_;
  f_tip_N_ += step_N.norm() > farthest_N ? farthest_N * step_N.normalized() : step_N;
  if (!has_load_) f_tip_N_ -= kForceDecay * along.dot(f_tip_N_) * along;
  return near;
}

bool SampleWatch::Whiten(const WatchedMoment& moment, const std::array<bool, 4>& sampled,
                         WatchedParameters& parameters, WatchedRows& rows) {
  const Measurements& z = moment.measurements;
  SetSample(moment, sampled);
  SetInputs(moment.change);
  const SolvedSample solved = SolveSample(set_, 0, inputs_, f_tip_N_, solver_);
  if (!solved.ok) {
    solver_.Reset();
    f_tip_N_.setZero();
    known_ = 0;
    before_.ok = false;
    return false;
  }
  const DiagnosisSample& now = set_.samples[0];
  FindRate(now.t_s, solved.at);
  const TimedGeometry geometry{solved.at, rate_, Geometry::Zero()};
  const SampleResidual compared = Compare(set_, now, inputs_, f_tip_N_, geometry, solved.by_inputs);

  rows.e.setZero();
  rows.X.setZero();
  rows.e.head<row::kCount>() = compared.residual;
  ByThree by_force = ByThree::Zero();
  by_force.topRows<row::kCount>() = compared.by_inputs.middleCols<3>(kForce);
  if (has_load_) {
    rows.e.segment<3>(kLoadRow) = z.load->f_tip_N - f_tip_N_;
    by_force.bottomRows<3>().setIdentity();
  }
  // Friction and play go by where shaft and wrist were before: by this moment's own readings their
  // noise would look like something explained.
  if (!before_.ok) before_ = {true, now.p_RW, solved.s_port_m, solved.ds_port_dfriction_m};
  std::swap(before_.p_RW, set_.samples[0].p_RW);
  const auto& columns = parameters.ColumnsAt(set_, before_.s_port_m, before_.ds_port_dfriction_m,
                                             inputs_[kPortFriction]);
  std::swap(before_.p_RW, set_.samples[0].p_RW);
  before_ = {true, now.p_RW, solved.s_port_m, solved.ds_port_dfriction_m};
  for (const InputChange::Column& column : columns) {
    rows.X.col(column.parameter).head<row::kCount>() += column.value *
                                                        parameters.Tolerance(column.parameter) *
                                                        compared.by_inputs.col(column.input);
  }
  const Matrix own = OwnCovariance(z);
  // What the force and the wrist's noise may explain.
  const Eigen::Vector3d along = (set_.p_RP - now.p_RW).normalized();
  const Eigen::Matrix3d T = along * along.transpose();
  const auto by_parts = [&](double across, double part_along) -> Eigen::Matrix3d {
    return force_unit_N_ * (across * (Eigen::Matrix3d::Identity() - T) + part_along * T);
  };
  const ByThree by_prior = by_force * by_parts(kForceAcross, kForceAlong);
  ByThree by_wrist = ByThree::Zero(), by_port = ByThree::Zero();
  by_wrist.topRows<row::kCount>() = compared.by_inputs.middleCols<3>(kWrist);
  by_port.topRows<row::kCount>() = compared.by_inputs.middleCols<3>(kPort);
  Eigen::Matrix<double, kRows, 1> by_friction = Eigen::Matrix<double, kRows, 1>::Zero();
  by_friction.head<row::kCount>() = compared.by_inputs.col(kPortFriction);
  const double wrist_m2 = z.wrist_position_noise_m * z.wrist_position_noise_m;
  Matrix known = own;
  known.noalias() += wrist_m2 * by_wrist * by_wrist.transpose();
  // What the model misses stays for a while, and is seen in so many samples.
  const double period_s = std::clamp(now.t_s - last_t_s_, kShortest_s, kStays_s);
  last_t_s_ = now.t_s;
  const double times = kStays_s / period_s;
  Matrix C = known;
  for (int r = 0; r < kRows; ++r) {
    const bool is_there = r >= kLoadRow ? has_load_ : now.present[static_cast<std::size_t>(r)];
    if (is_there) C(r, r) += times * kModelError * kModelError * own(r, r);
  }
  C.noalias() += times * kPlay_m * kPlay_m * by_wrist * by_wrist.transpose();
  C.noalias() += times * kBreathing_m * kBreathing_m * by_port * by_port.transpose();
  C.noalias() += times * kFriction * kFriction * by_friction * by_friction.transpose();
  C.noalias() += by_prior * by_prior.transpose();
  const Llt<kRows> factor(C);
  if (!factor.Succeeded()) return false;
  const Eigen::Vector3d step_N =
      ForceStep(known, by_force, by_parts(kStepAcross, kStepAlong), rows.e);
  rows.e = factor.SolveL(rows.e);
  rows.X = factor.SolveL(rows.X);
  return FollowForce(along, step_N) && rows.X.allFinite() && rows.e.allFinite();
}

}  // namespace flextip::diagnosis::running
