// What samples say of the watched parameters, as sums: block after block of time.
#pragma once

#include <Eigen/Dense>

#include "diagnosis/replay/sample_input.h"

namespace flextip::diagnosis::running {

/// Rows of a sample: those of sample_input.h, and the load's.
inline constexpr int kLoadRow = row::kCount, kRows = row::kCount + 3;
/// Parameters of all watched effects, in units of their tolerances: with a prior of one.
inline constexpr int kParameters = 48;
/// A sample's rows with unit covariance: e = X x + noise, x the parameters.
struct WatchedRows {
  Eigen::Matrix<double, kRows, 1> e = Eigen::Matrix<double, kRows, 1>::Zero();
  Eigen::Matrix<double, kRows, kParameters> X = Eigen::Matrix<double, kRows, kParameters>::Zero();
};

/// Sums over samples: H = X'X, g = X'e, of the parameters alone.
struct Information {
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  using Vector = Eigen::Matrix<double, kParameters, 1>;
  Matrix H = Matrix::Zero();
  Vector g = Vector::Zero();

  void Add(const WatchedRows& rows) {
    H.noalias() += rows.X.transpose() * rows.X;
    g.noalias() += rows.X.transpose() * rows.e;
  }
  void Add(const Information& other) {
    H += other.H;
    g += other.g;
  }
  void Scale(double factor) {
    H *= factor;
    g *= factor;
  }
  void Clear() {
    H.setZero();
    g.setZero();
  }
};

}  // namespace flextip::diagnosis::running
