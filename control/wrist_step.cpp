#include "control/wrist_step.h"

#include <algorithm>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr double kNearest = 0.02, kFarthest = 0.98;  // of the wrist from the port, over the length

constexpr double kRounding = 1e-12;

/// The step of a wrist at `from_port` straight away from the port, to the distance `nearest_m` from
/// it or as far as `max_step_m` goes.
Eigen::Vector3d AwayFromPort(const Eigen::Vector3d& from_port, double nearest_m,
                             double max_step_m) {
  // 1e-158 squares to next to nothing, and over 1e-310 nothing is finite.
  const double step = std::clamp(nearest_m - from_port.stableNorm(), 0.0, max_step_m);
  return step * from_port.stableNormalized();
}

}  // namespace

Eigen::Matrix3d TrustedStiffness(const Eigen::Matrix3d& K, const Eigen::Matrix3d& compliance,
                                 double limit) {
  const SymmetricEigen push(-0.5 * (K + K.transpose()));
  const Eigen::Matrix3d root =
      push.vectors * push.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * push.vectors.transpose();
  const Eigen::Matrix3d product = root * (0.5 * (compliance + compliance.transpose())) * root;
  const double largest = SymmetricEigenvalues(product)[2];
  const double part = largest > limit - 1.0 ? (limit - 1.0) / largest : 1.0;
  return -part * root * root;
}

BoundedStep BoundStep(const Eigen::Vector3d& step, const Eigen::Vector3d& p_RW,
                      const ShaftModel& model, double max_step_m) {
  BoundedStep bounded{step, false};
  const double size = step.norm();
  if (size > max_step_m) bounded.step_m *= max_step_m / size;
  const double L = model.instrument.length_m;
  const Eigen::Vector3d from_port = p_RW + bounded.step_m - model.p_RP;
  const double distance = from_port.norm();
  const double allowed = std::clamp(distance, kNearest * L, kFarthest * L);
  if (distance > 0.0 && allowed != distance)
    bounded.step_m += (allowed / distance - 1.0) * from_port;
  // Keeping away from the port must not make the step longer than it may be.
  if (distance == 0.0 || bounded.step_m.norm() > (1.0 + kRounding) * max_step_m) {
    bounded.step_m = distance > kNearest * L
                         ? Eigen::Vector3d(bounded.step_m * (max_step_m / bounded.step_m.norm()))
                         : AwayFromPort(p_RW - model.p_RP, kNearest * L, max_step_m);
  }
  bounded.limited = bounded.step_m != step;
  return bounded;
}

}  // namespace flextip
