// How large a vector that is known with a covariance is for certain.
#pragma once

#include <Eigen/Dense>

namespace flextip {

/// Returns the least norm of all vectors within `deviations` standard deviations of `mean`, an
/// ellipsoid of the positive semidefinite `covariance`; 0 where zero is among them, or a number is
/// not finite. Bounded, allocates nothing.
double LeastNorm(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance, double deviations);

}  // namespace flextip
