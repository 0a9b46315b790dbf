#include "calibration/camera/shape_elimination.h"

#include <algorithm>
#include <cmath>

namespace flextip {

void ShapeElimination::Add(int id, const Eigen::Matrix<double, 2, 3>& by_place,
                           const Eigen::MatrixXd& by_others, int column, int size) {
  Eigen::MatrixXd& with = corners_[id].with_others;
  if (with.size() == 0) with.setZero(3, size);
  with.middleCols(column, by_others.cols()) += by_place.transpose() * by_others;
}

void ShapeElimination::Add(int id, const Eigen::Matrix<double, 2, 3>& by_place) {
  corners_[id].own += by_place.transpose() * by_place;
}

void ShapeElimination::Eliminate(double weight_px_per_m, Eigen::MatrixXd& normal) {
  prior_px2_ = weight_px_per_m * weight_px_per_m;
  for (auto& [id, corner] : corners_) {
    corner.own.diagonal().array() += prior_px2_;
    normal -= corner.with_others.transpose() * corner.own.inverse() * corner.with_others;
  }
}

double ShapeElimination::Scatter(const Eigen::MatrixXd& inverse, double noise_px,
                                 BoardShape& shape) const {
  double trace = 0.0, squares = 0.0;  // of the places' covariance for a noise of 1 px
  for (const auto& [id, corner] : corners_) {
    squares += shape.Of(id).squaredNorm();
    const Eigen::Matrix3d own = corner.own.inverse();
    trace += own.trace();
    if (inverse.size() == 0) continue;
    const Eigen::MatrixXd back = own * corner.with_others;
    trace += (back * inverse * back.transpose()).trace();
  }
  const double count = 3.0 * static_cast<double>(corners_.size());
  shape.scatter_m = std::sqrt((squares + noise_px * noise_px * trace) / count);
  return std::max(0.0, count - prior_px2_ * trace);
}

}  // namespace flextip
