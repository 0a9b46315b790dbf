#include "control/small_decompositions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace flextip {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// The unit vector that B maps to (nearly) zero, for B symmetric of rank 2: across two of its rows,
/// the two that span the largest area.
Eigen::Vector3d NullVector(const Eigen::Matrix3d& B) {
  const Eigen::Vector3d a = B.col(0).cross(B.col(1)), b = B.col(1).cross(B.col(2)),
                        c = B.col(2).cross(B.col(0));
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), cc = c.squaredNorm();
  if (aa >= bb && aa >= cc) return a / std::sqrt(aa);
  return bb >= cc ? b / std::sqrt(bb) : c / std::sqrt(cc);
}

/// The larger eigenpair of B within the plane normal to the unit vector n.
Eigenpair LargestAcross(const Eigen::Matrix3d& B, const Eigen::Vector3d& n) {
  const Eigen::Vector3d e = (std::abs(n[0]) > std::abs(n[1]) ? Eigen::Vector3d(-n[2], 0.0, n[0])
                                                             : Eigen::Vector3d(0.0, n[2], -n[1]))
                                .normalized();
  const Eigen::Vector3d f = n.cross(e);
  const Eigen::Vector3d Be = B * e, Bf = B * f;
  const double mean = 0.5 * (e.dot(Be) + f.dot(Bf)), half = 0.5 * (e.dot(Be) - f.dot(Bf));
  const double off = e.dot(Bf), root = std::sqrt(half * half + off * off);
  if (root == 0.0) return {mean, e};
  // (half + root, off) and (off, root - half) are the same direction; the longer has no
  // cancellation.
  const Eigen::Vector3d v = half >= 0.0 ? Eigen::Vector3d((half + root) * e + off * f)
                                        : Eigen::Vector3d(off * e + (root - half) * f);
  return {mean + root, v.normalized()};
}

/// Turns columns i and j of W, and of V with it, until they are square to each other. False if
/// they were.
bool Rotate(SmallSvd& svd, Eigen::Matrix3d& W, int i, int j) {
  const double a = W.col(i).squaredNorm(), b = W.col(j).squaredNorm(), c = W.col(i).dot(W.col(j));
  if (std::abs(c) <= 0.5 * kEpsilon * std::sqrt(a * b)) return false;
  const double zeta = 0.5 * (b - a) / c;
  const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta));
  const double cosine = 1.0 / std::sqrt(1.0 + t * t), sine = t * cosine;
  for (Eigen::Matrix3d* M : {&W, &svd.V}) {
    const Eigen::Vector3d left = M->col(i);
    M->col(i) = cosine * left - sine * M->col(j);
    M->col(j) = sine * left + cosine * M->col(j);
  }
  return true;
}

}  // namespace

// In units of its spread, N has eigenvalues 2 cos(angle + 2 pi k / 3). The outer one that is far
// from the other two is well defined, with its vector; the others follow in the plane across it
// (Eberly, A Robust Eigensolver for 3x3 Symmetric Matrices, 2014).
Eigenpair LargestEigenpair(const Eigen::Matrix3d& N) noexcept {
  const double mean = N.trace() / 3.0;
  Eigen::Matrix3d B = N;
  B.diagonal().array() -= mean;
  const double spread = std::sqrt(B.squaredNorm() / 6.0);
  if (!(spread > 0.0)) return {mean, Eigen::Vector3d::UnitX()};
  B /= spread;
  const double half_det = std::clamp(0.5 * B.determinant(), -1.0, 1.0);
  const double angle = std::acos(std::abs(half_det)) / 3.0;
  const double outer = std::copysign(2.0 * std::cos(angle), half_det);
  Eigen::Matrix3d shifted = B;
  shifted.diagonal().array() -= outer;
  const Eigen::Vector3d n = NullVector(shifted);
  const Eigenpair found = outer > 0.0 ? Eigenpair{outer, n} : LargestAcross(B, n);
  return {mean + spread * found.value, found.vector};
}

SmallSvd DecomposeSmall(const Eigen::Matrix3d& A) noexcept {
  constexpr int kMaxSweeps = 16;
  SmallSvd svd;
  svd.V.setIdentity();
  Eigen::Matrix3d W = A;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const bool first = Rotate(svd, W, 0, 1), second = Rotate(svd, W, 0, 2),
               third = Rotate(svd, W, 1, 2);
    if (!first && !second && !third) break;
  }
  for (int i = 0; i < 3; ++i) {
    svd.sigma[i] = W.col(i).norm();
    svd.U.col(i).setZero();
    if (svd.sigma[i] > 0.0) svd.U.col(i) = W.col(i) / svd.sigma[i];
  }
  return svd;
}

int MissingRank(const Eigen::Vector3d& sigma) noexcept {
  const double limit = 8.0 * kEpsilon * sigma.maxCoeff();
  return static_cast<int>((sigma.array() <= limit).count());
}

}  // namespace flextip
