// What samples say of the watched parameters, as sums: block after block of time.
#pragma once

#include <Eigen/Dense>

#include "diagnosis/replay/sample_input.h"

namespace flextip::diagnosis::running {

/// Rows of a sample: those of sample_input.h, and the load's.
inline constexpr int kLoadRow = row::kCount, kRows = row::kCount + 3;
/// Parameters of all watched effects, in units of their tolerances: with a prior of one.
inline constexpr int kParameters = 48;
/// What is another in each block, within tolerance: where a breathing port is, how far it goes in
/// half the block, friction that sticks somewhere, the wrist within its play, and what the model
/// misses in each row.
inline constexpr int kPlaceColumn = kParameters, kGoingColumn = kPlaceColumn + 3;
inline constexpr int kStuckColumn = kGoingColumn + 3, kPlayColumn = kStuckColumn + 1;
inline constexpr int kMissedColumn = kPlayColumn + 3;
inline constexpr int kWandering = 10 + kRows;
inline constexpr int kColumns = kParameters + kWandering;

/// A sample's rows with unit covariance: e = X x + noise, x the parameters and what wanders.
struct WatchedRows {
  Eigen::Matrix<double, kRows, 1> e = Eigen::Matrix<double, kRows, 1>::Zero();
  Eigen::Matrix<double, kRows, kColumns> X = Eigen::Matrix<double, kRows, kColumns>::Zero();
};

/// Sums over samples: H = X'X, g = X'e, of the parameters alone.
struct Information {
  using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
  using Vector = Eigen::Matrix<double, kParameters, 1>;
  Matrix H = Matrix::Zero();
  Vector g = Vector::Zero();

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

/// The sums of one block while it grows.
class GrowingBlock {
 public:
  void Add(const WatchedRows& rows);
  int Samples() const { return samples_; }
  /// Returns the block's sums, what wanders eliminated by its prior of one; then begins anew.
  void Close(Information& closed);

 private:
  using Matrix = Eigen::Matrix<double, kColumns, kColumns>;
  Matrix H_ = Matrix::Zero();
  Eigen::Matrix<double, kColumns, 1> g_ = Eigen::Matrix<double, kColumns, 1>::Zero();
  int samples_ = 0;
};

}  // namespace flextip::diagnosis::running
