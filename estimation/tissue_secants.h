// The stiffness of the tissue under the tip, from how the estimated load changed with the estimated
// tip. Private to estimation.
#pragma once

#include <Eigen/Dense>

#include "core/state_text.h"

namespace flextip {

/// Least squares of df = K dp, K symmetric, over secants at least 2 mm long, the old ones fading,
/// each weighted by how well its forces are known: the force along the shaft hardly is.
class TissueSecants {
 public:
  /// Adds a tip and the force on it (m, N, in R), with the force's covariance
  /// `force_covariance_N2`.
  void Add(const Eigen::Vector3d& p_RE, const Eigen::Vector3d& f_tip_N,
           const Eigen::Matrix3d& force_covariance_N2);

  /// Returns df/dp (N/m), negative semidefinite: tissue only pushes back. Zero before the first
  /// secant and where the tip has travelled little.
  const Eigen::Matrix3d& Stiffness() const { return stiffness_N_m_; }

  void VisitState(StateText& state) {
    state(has_reference_);
    state(p_reference_);
    state(f_reference_N_);
    state(reference_covariance_N2_);
    state(information_);
    state(weighted_);
    state(stiffness_N_m_);
  }

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;  // xx, yy, zz, yz, xz, xy
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  bool has_reference_ = false;
  Eigen::Vector3d p_reference_ = Eigen::Vector3d::Zero(), f_reference_N_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d reference_covariance_N2_ = Eigen::Matrix3d::Zero();
  Matrix6d information_ = Matrix6d::Zero();
  Vector6d weighted_ = Vector6d::Zero();
  Eigen::Matrix3d stiffness_N_m_ = Eigen::Matrix3d::Zero();
};

}  // namespace flextip
