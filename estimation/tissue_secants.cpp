#include "estimation/tissue_secants.h"

#include <algorithm>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr double kSecant_m = 0.002;  // tip travel between two looks at the tissue
constexpr double kMemory = 0.9;      // weight of the past against a new secant
// Stiffness expected before anything is felt, and the least error of a force: together they say
// that 2 mm of travel is little.
constexpr double kPrior_N_m = 50.0, kLeastForce_N = 0.1;
constexpr double kStiffest_N_m = 2000.0;

/// Tissue only pushes back.
Eigen::Matrix3d PushingBack(const Eigen::Matrix3d& K) {
  const SymmetricEigen axes(K);
  const Eigen::Vector3d values = axes.values.cwiseMin(0.0).cwiseMax(-kStiffest_N_m);
  return axes.vectors * values.asDiagonal() * axes.vectors.transpose();
}

}  // namespace

void TissueSecants::Add(const Eigen::Vector3d& p_RE, const Eigen::Vector3d& f_tip_N,
                        const Eigen::Matrix3d& force_covariance_N2) {
  const Eigen::Vector3d dp = p_RE - p_reference_;
  if (has_reference_ && dp.norm() < kSecant_m) return;
  if (has_reference_) {
    Eigen::Matrix<double, 3, 6> by_K;         // K dp = by_K k
    by_K << dp.x(), 0, 0, 0, dp.z(), dp.y(),  //
        0, dp.y(), 0, dp.z(), 0, dp.x(),      //
        0, 0, dp.z(), dp.y(), dp.x(), 0;
    const Eigen::Matrix3d covariance = force_covariance_N2 + reference_covariance_N2_ +
                                       kLeastForce_N * kLeastForce_N * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d weight = covariance.inverse();
    information_ = kMemory * information_ + by_K.transpose() * weight * by_K;
    weighted_ = kMemory * weighted_ + by_K.transpose() * weight * (f_tip_N - f_reference_N_);
    Vector6d prior;  // the same for every set of axes: each entry off the diagonal is there twice
    prior << 1.0, 1.0, 1.0, 2.0, 2.0, 2.0;
    Matrix6d with_prior = information_;
    with_prior.diagonal() += prior / (kPrior_N_m * kPrior_N_m);
    const Vector6d k = Ldlt(with_prior).Solve(weighted_);
    Eigen::Matrix3d K;
    K << k[0], k[5], k[4], k[5], k[1], k[3], k[4], k[3], k[2];
    stiffness_N_m_ = PushingBack(K);
  }
  has_reference_ = true;
  p_reference_ = p_RE;
  f_reference_N_ = f_tip_N;
  reference_covariance_N2_ = force_covariance_N2;
}

}  // namespace flextip
