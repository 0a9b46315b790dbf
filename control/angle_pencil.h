// The angle between v and A v in three dimensions as an eigenvalue problem along a line.
//
// For s = v^T A v, m = |A v|^2, n = |v|^2 and any x > 0, 2 x s / (x^2 m + n) is never further from
// zero than cos(phi) = s / sqrt(m n), and equals it at x = sqrt(n / m). So the extreme of cos(phi)
// over all v is the extreme over x of the least eigenvalue of the pencil (x (A + A^T), x^2 A^T A +
// I). With A = U diag(sigma) V^T, Q = V^T U, tan(beta_i) = x sigma_i, C = diag(cos beta), S =
// diag(sin beta) and v = V C y that is the least eigenvalue of
//   K(x) = C Q S + S Q^T C = I - Z^T Z,  Z = Q S - C,
// with entries of the order of one however far apart A's singular values are. Everything here is in
// the basis V.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "control/small_decompositions.h"

namespace flextip {

/// One direction y, the best for its x.
struct PencilPoint {
  double x = 1.0;
  double missing = 0.0;  ///< 1 - K's least eigenvalue; (1 - cos phi) at the extreme
  double balance = 0.0;  ///< y^T (C^2 - S^2) y, positive where this y's own best x is larger
  double cosine = 1.0;   ///< cos(phi) of y
  Eigen::Vector3d y = Eigen::Vector3d::UnitX();

  /// log(PeakX() / x).
  double Offset() const { return std::atanh(balance); }
  /// x at which this y's 2 x s / (x^2 m + n) is its cosine.
  double PeakX() const { return x * std::sqrt((1.0 + balance) / (1.0 - balance)); }
};

/// C and S of the header at one x.
struct PencilScale {
  Eigen::Vector3d cosine;
  Eigen::Vector3d sine;
  Eigen::Vector3d difference;  ///< cos^2 - sin^2, without cancellation
};

/// A's singular value decomposition and what is made of it. A is at least of rank 1.
class AnglePencil {
 public:
  /// `missing_rank`: how many of the smallest singular values of A are zero in truth (0 to 2).
  AnglePencil(const SmallSvd& svd, int missing_rank) noexcept;

  PencilScale Scale(double x) const noexcept;
  PencilPoint Evaluate(double x) const noexcept;
  /// y^T (C^2 - S^2) y_2 at x.
  double Balance(double x, const Eigen::Vector3d& y, const Eigen::Vector3d& y_2) const noexcept;
  /// The angle between v and A v for v = V C(x) y (rad), accurate near 0 and pi.
  double Angle(double x, const Eigen::Vector3d& y) const noexcept;
  /// v = V C(x) y, of unit length.
  Eigen::Vector3d Direction(double x, const Eigen::Vector3d& y) const noexcept;

  /// Whether some v has A v = 0, and one that has.
  bool HasUnmoved() const { return sigma_.minCoeff() == 0.0; }
  Eigen::Vector3d Unmoved() const noexcept;

  const Eigen::Vector3d& Sigma() const { return sigma_; }
  const Eigen::Matrix3d& Q() const { return Q_; }
  /// All extremes are between these x, 1 / sigma_max and 1 / sigma_min. Without full rank the
  /// extreme may be a limit: `LargestX` is then where it is reached to working precision.
  double SmallestX() const { return smallest_x_; }
  double LargestX() const { return largest_x_; }

 private:
  Eigen::Vector3d sigma_;
  Eigen::Matrix3d Q_;
  Eigen::Matrix3d V_;
  double smallest_x_ = 1.0;
  double largest_x_ = 1.0;
};

}  // namespace flextip
