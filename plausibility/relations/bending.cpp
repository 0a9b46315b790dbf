#include "plausibility/relations/bending.h"

#include <algorithm>

#include "core/rotation.h"
#include "plausibility/relations/shaft_curve.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Where the shaft points at its far end.
std::optional<Vector3d> EndDirection(const Instant& now) {
  if (now.em0 && now.em0->q) return ShaftAxis(*now.em0->q);
  if (now.tip && now.tip->d) return *now.tip->d;
  return {};
}

}  // namespace

std::optional<Vector2d> TurnSeen(const Scene& /*scene*/, const Instant& now) {
  const auto end = EndDirection(now);
  if (!end || !now.wrist->q) return {};
  const Vector3d local = now.wrist->q->conjugate() * *end;
  // No shaft turns back. There the turn has no axis, and any will do.
  const Vector3d to = local.x() > -0.95 ? local : Vector3d(Vector3d::UnitY());
  const Vector3d turn = LogRotation(RotationWithoutTwist(Vector3d::UnitX(), to));
  return Vector2d(turn.y(), turn.z());
}

std::optional<Vector2d> TurnByMoments(const Scene& scene, const Instant& now) {
  if (!now.strain_Nm) return {};
  const double length = scene.instrument.length_m;
  const double s1 = scene.station_m[0], s2 = scene.station_m[1];
  if (!(s1 > 0.0) || !(s2 < length)) return {};
  const double port = std::clamp((scene.p_RP - now.wrist->p).norm(), 0.02 * length, 0.98 * length);
  const auto at_port = [&](double s, const Vector2d& m) -> Vector2d {
    return s < port ? m * port / s : m * (length - port) / (length - s);
  };
  const Vector2d before = at_port(s1, now.strain_Nm->head<2>());
  const Vector2d beyond = at_port(s2, now.strain_Nm->tail<2>());
  return Vector2d(0.5 * (before * port + beyond * (length - port)) /
                  scene.instrument.bending_stiffness_Nm2);
}

std::optional<Vector2d> MomentByLoad(const Scene& scene, const Instant& now) {
  const auto end = EndDirection(now);
  if (!now.load_N || !end || !now.wrist->q) return {};
  const Eigen::Matrix3d R_RW = now.wrist->q->toRotationMatrix();
  if (R_RW.col(0).dot(*end) < -0.9) return {};
  const Eigen::Matrix3d R = RotationWithoutTwist(R_RW.col(0), *end) * R_RW;
  const double arm = scene.instrument.length_m - scene.station_m[1];
  return Vector2d((R.transpose() * (arm * *end).cross(*now.load_N)).tail<2>());
}

std::optional<Vector3d> DeflectionSeen(const Scene& scene, const Instant& now) {
  const auto along = DirectionToPort(scene, now);
  if (!along) return {};
  Vector3d tip;
  if (now.tip) {
    tip = now.tip->p;
  } else if (now.em0 && now.em0->q) {
    tip = now.em0->p + scene.em0_from_tip_m * ShaftAxis(*now.em0->q);
  } else {
    return {};
  }
  const Vector3d off = tip - now.wrist->p;
  return Vector3d(off - off.dot(*along) * *along);
}

std::optional<Vector3d> DeflectionByLoad(const Scene& scene, const Instant& now) {
  const auto along = DirectionToPort(scene, now);
  if (!along || !now.load_N) return {};
  const double length = scene.instrument.length_m;
  const double beyond = length - (scene.p_RP - now.wrist->p).norm();
  if (!(beyond > 0.0)) return {};
  const Vector3d across = *now.load_N - now.load_N->dot(*along) * *along;
  return Vector3d(across * beyond * beyond * length /
                  (3.0 * scene.instrument.bending_stiffness_Nm2));
}

}  // namespace flextip::plausibility
