// The board's own shape beside all other parameters of a bundle adjustment: eliminated from the
// normal matrix, and how much it scatters. Private to camera/ and stereo/.
#pragma once

#include <Eigen/Dense>
#include <map>

#include "calibration/camera/solution.h"

namespace flextip {

/// J^T J between the corners' places (3 each) and the other parameters.
class ShapeElimination {
 public:
  /// Of one corner in one picture: its pixel's derivative by its place in B, and by the parameters
  /// that begin at `column` of `size`.
  void Add(int id, const Eigen::Matrix<double, 2, 3>& by_place, const Eigen::MatrixXd& by_others,
           int column, int size);
  /// Of one corner in one picture, by its place alone; once for each.
  void Add(int id, const Eigen::Matrix<double, 2, 3>& by_place);

  /// Takes the places, each held by `weight_px_per_m`, out of `normal` (for a noise of 1 px), whose
  /// inverse is then the others' covariance with the shape unknown.
  void Eliminate(double weight_px_per_m, Eigen::MatrixXd& normal);
  /// After Eliminate: sets `shape.scatter_m` with `inverse`, that of the normal matrix, and says
  /// how many parameters the pictures determined of the shape.
  double Scatter(const Eigen::MatrixXd& inverse, double noise_px, BoardShape& shape) const;

 private:
  struct Corner {
    Eigen::MatrixXd with_others;  // 3 x their number
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  };
  std::map<int, Corner> corners_;
  double prior_px2_ = 0.0;
};

/// What a metre off the described place costs, in px: noise over the shape's deviation.
inline double ShapeWeight(double noise_px, const BoardShape& shape) {
  return noise_px / shape.sd_m;
}

}  // namespace flextip
