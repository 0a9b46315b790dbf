// Sums over samples of a linear problem: all that evidence needs of the measurements.
#pragma once

#include <Eigen/Dense>

namespace flextip::diagnosis {

/// Sums over samples for z = X x + noise of unit covariance.
struct NormalSums {
  Eigen::MatrixXd H;    ///< X^T X
  Eigen::VectorXd g;    ///< X^T z
  double c = 0.0;       ///< z^T z
  double volume = 0.0;  ///< noise that unknown forces take up, to be put back on c (force_volume.h)
  long rows = 0;

  explicit NormalSums(Eigen::Index size = 0)
      : H(Eigen::MatrixXd::Zero(size, size)), g(Eigen::VectorXd::Zero(size)) {}
  void Add(const NormalSums& other, double weight = 1.0);
};

}  // namespace flextip::diagnosis
