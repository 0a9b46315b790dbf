// Decompositions of 3x3 matrices, several times faster than the general ones and, for singular
// values, accurate however far apart these are.
#pragma once

#include <Eigen/Dense>

namespace flextip {

/// An eigenvalue of a symmetric matrix and its unit eigenvector.
struct Eigenpair {
  double value = 0.0;
  Eigen::Vector3d vector = Eigen::Vector3d::UnitX();
};

/// The largest eigenvalue of the symmetric N (3x3, finite), to a few 1e-16 of N's norm. Where it is
/// (nearly) double, the vector is one of its plane.
Eigenpair LargestEigenpair(const Eigen::Matrix3d& N) noexcept;

/// Singular values in no order. Left vectors of zero values are zero.
struct SmallSvd {
  Eigen::Vector3d sigma;
  Eigen::Matrix3d U;
  Eigen::Matrix3d V;
};

/// A = U diag(sigma) V^T by one-sided Jacobi rotations (Hestenes 1958). For A = B D with D diagonal
/// and B well conditioned, each value is right to a few 1e-16 of itself (Demmel and Veselic 1992).
/// A: 3x3, finite, entries whose squares neither overflow nor matter when they underflow.
SmallSvd DecomposeSmall(const Eigen::Matrix3d& A) noexcept;

/// How many singular values count as zero: those up to 8 epsilon of the largest.
int MissingRank(const Eigen::Vector3d& sigma) noexcept;

}  // namespace flextip
