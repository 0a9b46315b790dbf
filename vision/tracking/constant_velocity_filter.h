// Where the tip is likely to be while it is not seen.
#pragma once

#include <Eigen/Dense>

#include "core/state_text.h"
#include "core/time_series.h"

namespace flextip {

/// A Kalman filter of constant velocity. Only predictions are taken from it: what is measured is
/// passed on as measured.
class ConstantVelocityFilter {
 public:
  explicit ConstantVelocityFilter(double acceleration_noise_m_s2)
      : acceleration_noise_m_s2_(acceleration_noise_m_s2) {}

  bool Started() const { return started_; }
  void Reset() { started_ = false; }
  /// The time of the last measurement.
  TimeNs LastTime() const { return t_ns_; }

  void Measure(TimeNs t_ns, const Eigen::Vector3d& p, const Eigen::Matrix3d& covariance_m2);

  /// The position is known to be `p` with this covariance, all that the filter knows of it
  /// included: only the velocity follows from the filter.
  void Replace(TimeNs t_ns, const Eigen::Vector3d& p, const Eigen::Matrix3d& covariance_m2);

  void VisitState(StateText& state) {
    state(started_);
    state(t_ns_);
    state(x_);
    state(P_);
  }

  /// Position and covariance at `t_ns`, after the last measurement; the filter stays where it is.
  struct Prediction {
    Eigen::Vector3d p;
    Eigen::Matrix3d covariance_m2;
  };
  Prediction At(TimeNs t_ns) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  void Advance(TimeNs t_ns, Vector6& x, Matrix6& P) const;

  double acceleration_noise_m_s2_;
  bool started_ = false;
  TimeNs t_ns_ = 0;
  Vector6 x_ = Vector6::Zero();  // position, velocity
  Matrix6 P_ = Matrix6::Zero();
};

}  // namespace flextip
