#include "pipeline/guard/sensor_tolerances.h"

#include <algorithm>
#include <cmath>

#include "pipeline/tip_fusion.h"
#include "vision/tracking/tip_prediction.h"

namespace flextip {
namespace {

constexpr double kLearn_s = 5.0;       // a drift is followed no faster
constexpr double kChanges = 0.4;       // part of a tolerance that changes from place to place
constexpr double kMostDeviations = 3;  // of an offset

}  // namespace

double ToleratedSensors::Offset::Doubt_m() const {
  return std::hypot(std::sqrt(variance_m2), kChanges * tolerance_m);
}

void ToleratedSensors::Offset::Learn(const Eigen::Vector3d& seen_m, double noise_m, double dt_s) {
  const double change_m = kChanges * tolerance_m;
  const double seen_m2 = noise_m * noise_m + change_m * change_m;
  const double by_doubt = variance_m2 / (variance_m2 + seen_m2);
  const double gain = std::max(by_doubt, std::min(1.0, dt_s / kLearn_s));
  variance_m2 *= 1.0 - by_doubt;
  mean_m += gain * (seen_m - mean_m);
  const double most_m = kMostDeviations * tolerance_m;
  if (mean_m.norm() > most_m) mean_m *= most_m / mean_m.norm();
}

ToleratedSensors::ToleratedSensors(const SensorTolerances& tolerances) : tolerances_(tolerances) {
  tip_.tolerance_m = tolerances.tip_m;
  em_.tolerance_m = tolerances.em_m;
  tip_.variance_m2 = tolerances.tip_m * tolerances.tip_m;
  em_.variance_m2 = tolerances.em_m * tolerances.em_m;
}

Measurements ToleratedSensors::Widened(const Measurements& z) const {
  Measurements wide = z;
  const double turn_rad = tolerances_.turn_rad;
  wide.wrist_position_noise_m = std::hypot(z.wrist_position_noise_m, tolerances_.wrist_m);
  wide.wrist_orientation_noise_rad = std::hypot(z.wrist_orientation_noise_rad, turn_rad);
  wide.tip_direction_noise_rad = std::hypot(z.tip_direction_noise_rad, turn_rad);
  wide.port_direction_noise_rad = std::hypot(z.port_direction_noise_rad, turn_rad);
  if (wide.tip) {
    const double doubt_m = tip_.Doubt_m();
    wide.tip->p_RE -= tip_.mean_m;
    wide.tip->covariance_m2.diagonal().array() += doubt_m * doubt_m;
  }
  if (wide.em) {
    wide.em->T_RS.p -= em_.mean_m;
    wide.em->position_noise_m = std::hypot(z.em->position_noise_m, em_.Doubt_m());
    wide.em->orientation_noise_rad = std::hypot(z.em->orientation_noise_rad, turn_rad);
  }
  // Moments and forces are compared with a bending by the stiffness that the data state. Places and
  // directions are compared with each other: the fitted load takes a wrong stiffness up.
  if (wide.strain) {
    const double part_Nm = tolerances_.stiffness * z.strain->moments_Nm.cwiseAbs().maxCoeff();
    wide.strain->moment_noise_Nm =
        std::hypot(z.strain->moment_noise_Nm, tolerances_.moment_Nm, part_Nm);
  }
  if (wide.load) {
    const double part_N = tolerances_.stiffness * z.load->f_tip_N.norm();
    wide.load->force_noise_N = std::hypot(z.load->force_noise_N, part_N);
  }
  return wide;
}

void ToleratedSensors::Learn(TimeNs t_ns, const Measurements& z, const Eigen::Vector3d& p_RE) {
  const double dt_s =
      learnt_ns_ == 0 ? 0.0 : 1e-9 * static_cast<double>(std::max<TimeNs>(0, t_ns - learnt_ns_));
  learnt_ns_ = t_ns;
  if (z.tip && z.tip->status != TipStatus::kLost)
    tip_.Learn(z.tip->p_RE - p_RE, MaxSd(z.tip->covariance_m2), dt_s);
  if (!z.em) return;
  const auto by_em = MeasuredTip({.em = z.em}, true);
  em_.Learn(*by_em - p_RE, z.em->position_noise_m, dt_s);
}

}  // namespace flextip
