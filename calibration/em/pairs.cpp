#include "calibration/em/pairs.h"

#include <fmt/format.h>

#include <algorithm>

#include "kinematics/straight.h"
#include "recording/resample.h"

namespace flextip {
namespace {

constexpr double kUnstatedPosition_m = 1e-4, kUnstatedDirection_rad = 1e-3;

double Stated(double noise, double otherwise) { return noise > 0 ? noise : otherwise; }

Eigen::Matrix3d SensorNoise(const EmStream& em) {
  const double sd = Stated(em.position_noise_m, kUnstatedPosition_m);
  return sd * sd * Eigen::Matrix3d::Identity();
}

}  // namespace

EmPairs PairByWrist(const Recording& recording) {
  const EmStream& em = *recording.em0;
  const double length_m = recording.instrument.length_m;
  const double wrist_sd = Stated(recording.wrist0->position_noise_m, kUnstatedPosition_m);
  EmPairs out;
  for (const auto& sample : em.samples) {
    const auto wrist = WristAt(*recording.wrist0, sample.t_ns);
    const StraightShaft shaft =
        wrist ? SolveStraight(wrist->p_RW, recording.p_RP, length_m) : StraightShaft{};
    if (!shaft.IsUsable()) {
      ++out.left_out;
      continue;
    }
    // d sensor / d wrist: the shaft's Jacobian at the sensor's place, between port and tip.
    const double part = (length_m - em.distance_from_tip_m) / length_m;
    const Eigen::Matrix3d J = Eigen::Matrix3d::Identity() - part * shaft.J_tip_port;
    out.pairs.push_back({sample.t_ns, Pose::FromQuaternion(sample.value.q_RS, sample.value.p_RS),
                         shaft.p_tip, shaft.t,
                         SensorNoise(em) + wrist_sd * wrist_sd * J * J.transpose()});
  }
  if (recording.instrument.mass_per_length_kg_m > 0) {
    out.warnings.emplace_back("the shaft has weight: the reference takes it as straight");
  }
  return out;
}

EmPairs PairByVision(const Recording& recording) {
  const EmStream& em = *recording.em0;
  const VisionStream& vision = *recording.vision0;
  const double turn =
      Stated(vision.direction_noise_rad, kUnstatedDirection_rad) * em.distance_from_tip_m;
  EmPairs out;
  for (const auto& frame : vision.tips) {
    const TipObservation& tip = frame.value;
    const auto sample = EmAt(em, frame.t_ns);
    if (!sample || tip.status != TipStatus::kOk || !tip.d_RE) {
      ++out.left_out;
      continue;
    }
    const Eigen::Vector3d& t = *tip.d_RE;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - t * t.transpose();
    out.pairs.push_back({frame.t_ns, Pose::FromQuaternion(sample->q_RS, sample->p_RS), tip.p_RE, t,
                         SensorNoise(em) + tip.covariance_m2 + turn * turn * across});
  }
  return out;
}

}  // namespace flextip
