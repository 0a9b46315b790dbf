// The lens models of core/camera.h for any scalar: for Ceres, which differentiates them by its own
// numbers. vision/camera_model.h is the same in doubles. Private to this folder.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "core/camera.h"

namespace flextip {

/// OpenCV's lens on the plane z = 1 with the first `kTerms` of k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4.
template <int kTerms, class T>
Eigen::Matrix<T, 2, 1> DistortOpenCv(const T* k, const Eigen::Matrix<T, 2, 1>& m) {
  const T &x = m.x(), &y = m.y();
  const T r2 = x * x + y * y;
  T f = T(1) + r2 * (k[0] + r2 * k[1]);
  if constexpr (kTerms >= 5) f += r2 * r2 * r2 * k[4];
  if constexpr (kTerms >= 8) f /= T(1) + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  Eigen::Matrix<T, 2, 1> d(x * f + T(2) * k[2] * x * y + k[3] * (r2 + T(2) * x * x),
                           y * f + k[2] * (r2 + T(2) * y * y) + T(2) * k[3] * x * y);
  if constexpr (kTerms >= 12) {
    d.x() += r2 * (k[8] + r2 * k[9]);
    d.y() += r2 * (k[10] + r2 * k[11]);
  }
  return d;
}

/// Kannala and Brandt: theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8).
template <class T>
Eigen::Matrix<T, 2, 1> DistortEquidistant(const T* k, const Eigen::Matrix<T, 2, 1>& m) {
  using std::atan;
  using std::sqrt;
  const T r2 = m.x() * m.x() + m.y() * m.y();
  if (r2 < T(1e-12)) return m * (T(1) + (k[0] - T(1.0 / 3.0)) * r2);
  const T r = sqrt(r2), theta = atan(r), t2 = theta * theta;
  const T theta_d = theta * (T(1) + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  return m * (theta_d / r);
}

/// The lens on the plane z = 1, in focal lengths from the principal point.
template <Distortion kModel, int kTerms, class T>
Eigen::Matrix<T, 2, 1> DistortLens(const T* k, const Eigen::Matrix<T, 2, 1>& m) {
  if constexpr (kModel == Distortion::kEquidistant) {
    return DistortEquidistant(k, m);
  } else {
    return DistortOpenCv<kTerms>(k, m);
  }
}

}  // namespace flextip
