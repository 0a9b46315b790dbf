#include "vision/tracking/constant_velocity_filter.h"

#include "core/linear_algebra.h"

namespace flextip {

// An instrument's tip seldom moves faster than this: the spread of the unknown first velocity.
constexpr double kFirstSpeed_m_s = 0.1;

// How long an acceleration lasts: the density of the white noise that takes its place is its
// variance times this.
constexpr double kAccelerationTime_s = 0.033;
// Squared innovation over its covariance beyond which the tip has jumped.
constexpr double kJump = 100.0;

// x' = F x, P' = F P F^T + Q with white acceleration. (A constant acceleration between two frames
// would double every velocity error once positions are exact.)
void ConstantVelocityFilter::Advance(TimeNs t_ns, Vector6& x, Matrix6& P) const {
  const double dt = 1e-9 * static_cast<double>(t_ns - t_ns_);
  const double q = acceleration_noise_m_s2_ * acceleration_noise_m_s2_ * kAccelerationTime_s;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  Matrix6 F = Matrix6::Identity(), Q;
  F.topRightCorner<3, 3>() = dt * I;
  Q << dt * dt * dt / 3 * I, dt * dt / 2 * I, dt * dt / 2 * I, dt * I;
  x = F * x;
  P = F * P * F.transpose() + q * Q;
}

void ConstantVelocityFilter::Measure(TimeNs t_ns, const Eigen::Vector3d& p,
                                     const Eigen::Matrix3d& covariance_m2) {
  if (!started_) {
    x_ << p, Eigen::Vector3d::Zero();
    P_.setZero();
    P_.topLeftCorner<3, 3>() = covariance_m2;
    P_.bottomRightCorner<3, 3>() = kFirstSpeed_m_s * kFirstSpeed_m_s * Eigen::Matrix3d::Identity();
    started_ = true;
    t_ns_ = t_ns;
    return;
  }
  Advance(t_ns, x_, P_);
  t_ns_ = t_ns;
  const Eigen::Matrix3d S = P_.topLeftCorner<3, 3>() + covariance_m2;
  const Eigen::Vector3d innovation = p - x_.head<3>();
  if (MahalanobisSquared(innovation, S) > kJump) {
    started_ = false;
    return Measure(t_ns, p, covariance_m2);
  }
  const Eigen::Matrix<double, 6, 3> K = Ldlt(S).Solve(P_.topRows<3>()).transpose();
  x_ += K * innovation;
  const Matrix6 updated = P_ - K * P_.topRows<3>();
  P_ = 0.5 * (updated + updated.transpose());
}

// The velocity given the position stays as it is; the position's distribution is another.
void ConstantVelocityFilter::Replace(TimeNs t_ns, const Eigen::Vector3d& p,
                                     const Eigen::Matrix3d& covariance_m2) {
  if (!started_) return Measure(t_ns, p, covariance_m2);
  Advance(t_ns, x_, P_);
  t_ns_ = t_ns;
  const Eigen::Matrix3d before = P_.topLeftCorner<3, 3>();
  const Eigen::Matrix3d gain = Ldlt(before).Solve(P_.topRightCorner<3, 3>()).transpose();
  const Eigen::Matrix3d velocity =
      P_.bottomRightCorner<3, 3>() + gain * (covariance_m2 - before) * gain.transpose();
  x_.tail<3>() += gain * (p - x_.head<3>());
  x_.head<3>() = p;
  P_ << covariance_m2, covariance_m2 * gain.transpose(), gain * covariance_m2,
      0.5 * (velocity + velocity.transpose());
}

ConstantVelocityFilter::Prediction ConstantVelocityFilter::At(TimeNs t_ns) const {
  Vector6 x = x_;
  Matrix6 P = P_;
  Advance(t_ns, x, P);
  return {x.head<3>(), P.topLeftCorner<3, 3>()};
}

}  // namespace flextip
