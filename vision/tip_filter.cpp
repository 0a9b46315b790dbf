#include "vision/tip_filter.h"

namespace flextip {

// An instrument's tip seldom moves faster than this: the spread of the unknown first velocity.
constexpr double kFirstSpeed_m_s = 0.1;

// x' = F x, P' = F P F^T + Q; the acceleration is taken as constant between two frames and
// independent from frame to frame.
void TipFilter::Advance(TimeNs t_ns, Vector6& x, Matrix6& P) const {
  const double dt = 1e-9 * static_cast<double>(t_ns - t_ns_);
  Matrix6 F = Matrix6::Identity();
  F.topRightCorner<3, 3>() = dt * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 6, 3> G;
  G << 0.5 * dt * dt * Eigen::Matrix3d::Identity(), dt * Eigen::Matrix3d::Identity();
  x = F * x;
  P = F * P * F.transpose() +
      acceleration_noise_m_s2_ * acceleration_noise_m_s2_ * G * G.transpose();
}

void TipFilter::Measure(TimeNs t_ns, const Eigen::Vector3d& p,
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
  const Eigen::Matrix<double, 6, 3> K = S.ldlt().solve(P_.topRows<3>()).transpose();
  x_ += K * (p - x_.head<3>());
  const Matrix6 updated = P_ - K * P_.topRows<3>();
  P_ = 0.5 * (updated + updated.transpose());
}

TipFilter::Prediction TipFilter::At(TimeNs t_ns) const {
  Vector6 x = x_;
  Matrix6 P = P_;
  Advance(t_ns, x, P);
  return {x.head<3>(), P.topLeftCorner<3, 3>()};
}

}  // namespace flextip
