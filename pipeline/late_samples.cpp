#include "pipeline/late_samples.h"

#include <algorithm>
#include <cmath>

#include "control/wrist_step.h"
#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

/// A place on the shaft and what moves it.
struct Place {
  Eigen::Vector3d p, t;
  Eigen::Matrix3d by_wrist, by_force, t_by_force;
};

/// Returns the tip, or the shaft `distance_from_tip_m` before it.
Place PlaceOn(const ShaftRodState& rod, double distance_from_tip_m) {
  if (distance_from_tip_m == 0.0)
    return {rod.p_RE, rod.end.t, rod.dp_RE.leftCols<3>(), rod.dp_RE.rightCols<3>(),
            rod.end.dt.rightCols<3>()};
  const ShaftSection& at = rod.stations[0];
  return {at.p, at.t, at.dp.leftCols<3>(), at.dp.rightCols<3>(), at.dt.rightCols<3>()};
}

}  // namespace

void LateSamples::VisitState(StateText& state) {
  state(options_.tip_time_sd_s);
  state(options_.em0_time_sd_s);
  state(history_);
  state(by_sensors_count_);
  const std::size_t size = by_sensors_.size();
  if (by_sensors_count_ > size) throw InputError("saved state: more tips than are kept");
  if (state.Reading()) next_ = by_sensors_count_ % size;
  for (std::size_t i = by_sensors_count_; i > 0; --i) state(by_sensors_[(next_ + size - i) % size]);
  state(tip_);
  state(tip_first_ns_);
  state(tip_rods_);
  state(em0_rods_);
  state(load_);
  state(drift_variance_N2_s_);
}

void LateSamples::Note(const SensorReadings& readings) { history_.Add(readings); }

bool LateSamples::HasLateTip(const SensorReadings& readings) const {
  return readings.tip && readings.wrist && readings.tip->value.tip.status != TipStatus::kLost &&
         Seconds(readings.wrist->t_ns - readings.tip->t_ns) > options_.late_s;
}

std::optional<SensorReadings> LateSamples::PastAt(TimeNs t_ns,
                                                  const SensorReadings& readings) const {
  if (!readings.wrist || t_ns >= readings.wrist->t_ns) return readings;
  auto then = history_.At(t_ns);
  if (then) then->tip = readings.tip;
  return then;
}

void LateSamples::NoteTipBySensors(TimeNs t_ns, const Eigen::Vector3d& p_RE,
                                   const Eigen::Matrix3d& covariance_m2) {
  by_sensors_[next_] = {t_ns, p_RE, covariance_m2};
  next_ = (next_ + 1) % by_sensors_.size();
  by_sensors_count_ = std::min(by_sensors_count_ + 1, by_sensors_.size());
}

std::optional<LateSamples::TipBySensors> LateSamples::TipBySensorsAt(TimeNs t_ns) const {
  constexpr double kFarthest_s = 0.05;
  const TipBySensors* after = nullptr;
  for (std::size_t i = 1; i <= by_sensors_count_; ++i) {
    const TipBySensors& tip = by_sensors_[(next_ + by_sensors_.size() - i) % by_sensors_.size()];
    if (tip.t_ns > t_ns) {
      after = &tip;
      continue;
    }
    if (tip.t_ns == t_ns) return tip;
    if (after == nullptr || Seconds(after->t_ns - tip.t_ns) > kFarthest_s) return {};
    const double u =
        static_cast<double>(t_ns - tip.t_ns) / static_cast<double>(after->t_ns - tip.t_ns);
    return TipBySensors{t_ns, Interpolate(tip.p_RE, after->p_RE, u), tip.covariance_m2};
  }
  return {};
}

/// A load that grows steadily is as far off after this step as the random walk says.
void LateSamples::Learn(TimeNs t_ns, const ShaftModel& model) {
  constexpr double kStep_s = 0.2, kMemory = 0.8;
  if (!model.force_known) return;
  const double seconds = load_ ? Seconds(t_ns - load_->t_ns) : 0.0;
  if (load_ && seconds < kStep_s) return;
  if (load_ && seconds < 3 * kStep_s) {
    const double variance_s = (model.f_tip_N - load_->value).squaredNorm() / 3.0 / seconds;
    drift_variance_N2_s_ = std::max(kMemory * drift_variance_N2_s_, variance_s);
  }
  load_ = {t_ns, model.f_tip_N};
}

/// To first order in the tissue: the force at the tip follows its way by the tissue's stiffness, as
/// in the controller's Jacobian.
std::optional<LateSamples::Motion> LateSamples::MotionByRod(TimeNs t_ns, double time_sd_s,
                                                            const Sample<WristMeasurement>& wrist,
                                                            const ShaftModel& model,
                                                            double distance_from_tip_m,
                                                            Rods& rods) const {
  const auto w_then = history_.WristAt(t_ns);
  if (!w_then) return {};
  const RodStation station{distance_from_tip_m, true};
  const std::span<const RodStation> stations(&station, distance_from_tip_m > 0.0 ? 1 : 0);
  const ShaftRodState then = rods.then.Solve(RodOf(model, w_then->p_RW), stations);
  const ShaftRodState now = rods.now.Solve(RodOf(model, wrist.value.p_RW), stations);
  if (!then.IsUsable() || !now.IsUsable()) return {};

  const Eigen::Matrix3d C = now.dp_RE.rightCols<3>();
  const Eigen::Matrix3d K = TrustedStiffness(model.tissue_stiffness_N_m, C, max_tissue_gain_);
  const Eigen::Matrix3d yields = (Eigen::Matrix3d::Identity() - C * K).inverse();
  const Eigen::Vector3d df_N = K * (yields * (now.p_RE - then.p_RE));
  const Place a = PlaceOn(then, distance_from_tip_m), b = PlaceOn(now, distance_from_tip_m);
  const Eigen::Matrix3d J = b.by_wrist + b.by_force * K * yields * now.dp_RE.leftCols<3>();
  const Eigen::Vector3d speed_m_s = J * history_.WristVelocityAt(t_ns);

  Motion motion;
  motion.way_m = b.p - a.p + b.by_force * df_N;
  motion.turn = RotationWithoutTwist(a.t, b.t);
  const Eigen::Vector3d doubt_m = J * history_.WristDoubtAt(t_ns);
  motion.by_time_m2 =
      time_sd_s * time_sd_s * speed_m_s * speed_m_s.transpose() + doubt_m * doubt_m.transpose();
  if (wrist.t_ns <= t_ns) return motion;
  const double gone_m = options_.way_error * motion.way_m.norm();
  const double unit_N = model.instrument.bending_stiffness_Nm2 /
                        (model.instrument.length_m * model.instrument.length_m);
  const double least_N = options_.force_drift_units * unit_N;
  const double drift_N2 =
      std::max(drift_variance_N2_s_, least_N * least_N) * Seconds(wrist.t_ns - t_ns);
  const double wrist_m2 = 2.0 * wrist.value.position_noise_m * wrist.value.position_noise_m;
  motion.covariance_m2 += wrist_m2 * J * J.transpose() +
                          drift_N2 * b.by_force * b.by_force.transpose() +
                          gone_m * gone_m * Eigen::Matrix3d::Identity();
  motion.turn_sd_rad = std::hypot(options_.way_error * LogRotation(motion.turn).norm(),
                                  std::sqrt(0.5 * drift_N2) * b.t_by_force.norm());
  return motion;
}

/// Joins the way by the rod and the way that the other sensors saw, by their covariances. The other
/// sensors' tip is off by the same amount then and now, as far as port and shaft are off. So the
/// sum of both variances is more than that of the way: what they say weighs rather too little.
void LateSamples::JoinSensors(TimeNs from_ns, TimeNs to_ns, Motion& motion) const {
  const auto from = TipBySensorsAt(from_ns), to = TipBySensorsAt(to_ns);
  if (!from || !to || to_ns <= from_ns) return;
  const Eigen::Matrix3d seen_m2 = from->covariance_m2 + to->covariance_m2;
  const Eigen::Matrix3d& P = motion.covariance_m2;
  const Eigen::Matrix3d gain = Ldlt(Eigen::Matrix3d(P + seen_m2)).Solve(P).transpose();
  motion.way_m += gain * (to->p_RE - from->p_RE - motion.way_m);
  const Eigen::Matrix3d left = P - gain * P;
  motion.covariance_m2 = 0.5 * (left + left.transpose());
}

bool LateSamples::Carry(const ShaftModel& model, SensorReadings& readings) {
  if (!readings.wrist) return false;
  if (readings.em0 && options_.carry_em0) CarryEm0(model, readings);
  return CarryTip(model, readings);
}

bool LateSamples::CarryTip(const ShaftModel& model, SensorReadings& readings) {
  const Sample<WristMeasurement>& wrist = *readings.wrist;
  if (readings.tip && readings.tip->value.tip.status != TipStatus::kLost) {
    tip_ = readings.tip;
    tip_first_ns_ = wrist.t_ns;
  } else if (tip_ && Seconds(wrist.t_ns - tip_first_ns_) > options_.keep_s) {
    tip_.reset();
  }
  if (!tip_) return false;
  const bool is_late = Seconds(wrist.t_ns - tip_->t_ns) > options_.late_s;
  readings.tip = tip_;
  if (!is_late && options_.tip_time_sd_s == 0.0) return false;
  auto motion = MotionByRod(tip_->t_ns, options_.tip_time_sd_s, wrist, model, 0.0, tip_rods_);
  if (!motion) {
    readings.tip.reset();
    return false;
  }
  JoinSensors(tip_->t_ns, wrist.t_ns, *motion);
  TipObservation& tip = readings.tip->value.tip;
  tip.p_RE += motion->way_m;
  tip.covariance_m2 += motion->covariance_m2 + motion->by_time_m2;
  if (tip.d_RE) tip.d_RE = motion->turn * *tip.d_RE;
  double& direction_noise_rad = readings.tip->value.direction_noise_rad;
  direction_noise_rad = std::hypot(direction_noise_rad, motion->turn_sd_rad);
  return is_late;
}

void LateSamples::CarryEm0(const ShaftModel& model, SensorReadings& readings) {
  EmMeasurement& em = readings.em0->value;
  const auto motion = MotionByRod(readings.em0->t_ns, options_.em0_time_sd_s, *readings.wrist,
                                  model, em.distance_from_tip_m, em0_rods_);
  if (!motion) {
    readings.em0.reset();
    return;
  }
  em.T_RS.p += motion->way_m;
  em.T_RS.R = motion->turn * em.T_RS.R;
  em.position_noise_m = std::hypot(
      em.position_noise_m, std::sqrt((motion->covariance_m2 + motion->by_time_m2).trace() / 3.0));
  em.orientation_noise_rad = std::hypot(em.orientation_noise_rad, motion->turn_sd_rad);
}

}  // namespace flextip
