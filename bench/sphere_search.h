// The search that the thesis names for (2.9): all directions of a dense grid, each maximum of the
// grid then refined. Slow; the peer of `control/motion_error.h`, and where its tests start from.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

namespace flextip {

/// The angle between H w and T w for directions w: with H = I and T = A that between the desired
/// and the actual motion; with H = J_hat and T = J the same without the inverse.
template <int N>
struct MotionPair {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  Matrix H = Matrix::Identity();
  Matrix T = Matrix::Identity();

  /// Grows with the angle and takes no root: -cos |cos|.
  double Key(const Vector& w) const {
    const Vector desired = H * w, actual = T * w;
    const double dot = desired.dot(actual);
    return -dot * std::abs(dot) / (desired.squaredNorm() * actual.squaredNorm());
  }

  /// Grows with the angle, too; smooth, and accurate near pi where `past` 90 degrees, else near 0.
  double Height(const Vector& w, bool past) const {
    const Vector desired = H * w, actual = T * w;
    const double across = Across(desired, actual);
    const double sine2 = across * across / (desired.squaredNorm() * actual.squaredNorm());
    const bool is_past = desired.dot(actual) < 0.0;
    if (is_past == past) return past ? -sine2 : sine2;
    return is_past ? 2.0 - sine2 : sine2 - 2.0;
  }

  /// rad, accurate near 0 and pi.
  double Angle(const Vector& w) const {
    const Vector desired = H * w, actual = T * w;
    return std::atan2(Across(desired, actual), desired.dot(actual));
  }

  static double Across(const Vector& a, const Vector& b) {
    if constexpr (N == 2) {
      return std::abs(a[0] * b[1] - a[1] * b[0]);
    } else {
      return a.cross(b).norm();
    }
  }
};

template <int N>
struct SphereMaximum {
  double angle = -1.0;  // rad
  Eigen::Matrix<double, N, 1> w = Eigen::Matrix<double, N, 1>::Zero();
};

/// w on a face of the cube around the sphere: coordinate `face` is 1, the others are x and y.
template <int N>
Eigen::Matrix<double, N, 1> OnFace(int face, double x, double y) {
  Eigen::Matrix<double, N, 1> w;
  w[face] = 1.0;
  w[(face + 1) % N] = x;
  if constexpr (N == 3) w[(face + 2) % N] = y;
  return w;
}

/// Climbs on a face from (x, y): a stencil of step `h`, the top of the parabola through it where it
/// has one, and a smaller stencil where neither is higher.
template <int N>
SphereMaximum<N> Refine(const MotionPair<N>& pair, int face, double x, double y, double h) {
  constexpr int kMaxRounds = 200;
  constexpr double kSmallest = 1e-13;
  const int rows = N == 3 ? 1 : 0;
  const bool past = pair.Key(OnFace<N>(face, x, y)) > 0.0;
  double best = pair.Height(OnFace<N>(face, x, y), past);
  for (int round = 0; round < kMaxRounds && h > kSmallest; ++round) {
    std::array<std::array<double, 3>, 3> f{};  // [x][y]
    double top = best, top_x = x, top_y = y;
    const auto look = [&](double at_x, double at_y) {
      const double height = pair.Height(OnFace<N>(face, at_x, at_y), past);
      if (height > top) top = height, top_x = at_x, top_y = at_y;
      return height;
    };
    for (int i = -1; i <= 1; ++i) {
      for (int j = -rows; j <= rows; ++j) {
        f[i + 1][j + 1] = i == 0 && j == 0 ? best : look(x + i * h, y + j * h);
      }
    }
    const double gx = 0.5 * (f[2][1] - f[0][1]), xx = f[2][1] - 2.0 * best + f[0][1];
    double step_x = 0.0, step_y = 0.0;
    if constexpr (N == 3) {
      const double gy = 0.5 * (f[1][2] - f[1][0]), yy = f[1][2] - 2.0 * best + f[1][0];
      const double xy = 0.25 * (f[2][2] - f[2][0] - f[0][2] + f[0][0]);
      const double det = xx * yy - xy * xy;
      if (xx < 0.0 && det > 0.0) {
        step_x = (xy * gy - yy * gx) / det;
        step_y = (xy * gx - xx * gy) / det;
      }
    } else if (xx < 0.0) {
      step_x = -gx / xx;
    }
    look(x + h * step_x, y + h * step_y);
    if (!(top > best)) h *= 0.25;
    best = top;
    x = top_x;
    y = top_y;
  }
  const Eigen::Matrix<double, N, 1> w = OnFace<N>(face, x, y);
  return {pair.Angle(w), w.normalized()};
}

/// All directions of a grid of n cells along each edge of the cube (n + 1 on a quarter circle),
/// each maximum of the grid refined. `grid` is working space.
template <int N>
SphereMaximum<N> SearchSphere(const MotionPair<N>& pair, int n, std::vector<double>& grid) {
  const double h = 2.0 / n;
  const int side = n + 1, rows = N == 3 ? side : 1;
  SphereMaximum<N> best;
  grid.resize(static_cast<std::size_t>(side) * rows);
  for (int face = 0; face < N; ++face) {
    const auto at = [&](int i, int j) -> double& { return grid[i + side * j]; };
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < side; ++i) {
        at(i, j) = pair.Key(OnFace<N>(face, i * h - 1.0, j * h - 1.0));
      }
    }
    const auto is_top = [&](int i, int j) {
      for (int k = std::max(0, j - 1); k <= std::min(rows - 1, j + 1); ++k) {
        for (int l = std::max(0, i - 1); l <= std::min(side - 1, i + 1); ++l) {
          if (at(l, k) > at(i, j)) return false;
        }
      }
      return true;
    };
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < side; ++i) {
        if (!is_top(i, j)) continue;
        const SphereMaximum<N> top = Refine(pair, face, i * h - 1.0, j * h - 1.0, h);
        if (top.angle > best.angle) best = top;
      }
    }
  }
  return best;
}

}  // namespace flextip
