#include "workspace/measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flextip {
namespace {

double AngleBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}
double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// By small steps of what is left of the move.
template <int N>
double Stray(const MatrixN<N>& A, const VectorN<N>& v) {
  constexpr double kStep = 0.05, kDone = 0.02, kEndless = 10.0;
  constexpr int kMost = 4000;
  const MatrixN<N> left_over = MatrixN<N>::Identity() - kStep / std::max(A.norm(), 1e-12) * A;
  VectorN<N> left = v;
  double stray = 0.0;
  for (int i = 0; i < kMost; ++i) {
    left = left_over * left;
    const double size = left.norm();
    if (size > kEndless) return kEndless;
    stray = std::max(stray, (left - left.dot(v) * v).norm());
    if (size < std::max(kDone, stray)) return stray;
  }
  return kEndless;
}

}  // namespace

template <int N>
PointMeasures<N> MeasureAt(const MapSetup<N>& setup, TrueShaft<N>& shaft, const VectorN<N>& p_tip) {
  PointMeasures<N> at;
  at.p_tip = p_tip;
  at.state = shaft.AtTip(p_tip);
  if (!at.state) return at;
  const auto belief = Believe(setup.truth, setup.error, at.state->theta);
  if (!belief) return at;
  at.step = FindStepError(at.state->J, belief->J_hat, setup.gain);
  at.angle = FindLargestAngle(at.state->J, belief->J_hat);
  if (at.step.IsUsable()) at.A = setup.gain * at.state->J * belief->J_hat.inverse();
  return at;
}

template <int N>
double DirectionError(const MatrixN<N>& A, const VectorN<N>& v, MotionFault fault) {
  if (fault == MotionFault::kStray) return Stray<N>(A, v.normalized());
  const VectorN<N> moved = A * v;
  if (fault == MotionFault::kNorm) return (v - moved).norm() / v.norm();
  return moved.squaredNorm() > 0.0 ? AngleBetween(v, moved) : std::numbers::pi;
}

template PointMeasures<2> MeasureAt(const MapSetup<2>&, TrueShaft<2>&, const VectorN<2>&);
template PointMeasures<3> MeasureAt(const MapSetup<3>&, TrueShaft<3>&, const VectorN<3>&);
template double DirectionError(const MatrixN<2>&, const VectorN<2>&, MotionFault);
template double DirectionError(const MatrixN<3>&, const VectorN<3>&, MotionFault);

}  // namespace flextip
