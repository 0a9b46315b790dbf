#include "calibration/tip/tip_poses.h"

namespace flextip {
namespace {

constexpr double kUnstatedPosition_m = 1e-4, kUnstatedOrientation_rad = 1e-3;

Matrix6d NoiseOf(double position_m, double orientation_rad) {
  const double p = position_m > 0 ? position_m : kUnstatedPosition_m;
  const double w = orientation_rad > 0 ? orientation_rad : kUnstatedOrientation_rad;
  Matrix6d C = Matrix6d::Zero();
  C.diagonal() << Eigen::Vector3d::Constant(w * w), Eigen::Vector3d::Constant(p * p);
  return C;
}

}  // namespace

std::vector<PivotPose> WristPoses(const Recording& recording) {
  std::vector<PivotPose> poses;
  if (!recording.wrist0) return poses;
  const WristStream& wrist = *recording.wrist0;
  const Matrix6d noise = NoiseOf(wrist.position_noise_m, wrist.orientation_noise_rad);
  poses.reserve(wrist.samples.size());
  for (const auto& sample : wrist.samples) {
    if (!sample.value.q_RW) continue;
    poses.push_back(
        {sample.t_ns, Pose::FromQuaternion(*sample.value.q_RW, sample.value.p_RW), noise});
  }
  return poses;
}

std::vector<PivotPose> EmPoses(const Recording& recording) {
  std::vector<PivotPose> poses;
  if (!recording.em0) return poses;
  const EmStream& em = *recording.em0;
  const Matrix6d noise = NoiseOf(em.position_noise_m, em.orientation_noise_rad);
  poses.reserve(em.samples.size());
  for (const auto& sample : em.samples) {
    poses.push_back(
        {sample.t_ns, Pose::FromQuaternion(sample.value.q_RS, sample.value.p_RS), noise});
  }
  return poses;
}

std::optional<PivotPose> CollarPivotPose(const TipTrack& track, TimeNs t_ns) {
  if (track.tip.status != TipStatus::kOk || track.ambiguous) return {};
  return PivotPose{t_ns, track.T_RE, track.covariance};
}

}  // namespace flextip
