#include "calibration/stereo/solution.h"

#include <cmath>

namespace flextip {

int StereoSolution::CornersUsed() const {
  int count = 0;
  for (const StereoView& view : views) {
    for (const SolvedView& eye : view.eyes) count += eye.CountUsed();
  }
  return count;
}

double StereoSolution::RmsPx(int eye) const {
  double sum = 0.0, count = 0.0;
  for (const StereoView& view : views) {
    for (int e = 0; e < 2; ++e) {
      if (eye >= 0 && e != eye) continue;
      const double n = view.eyes[e].CountUsed();
      sum += n * std::pow(view.eyes[e].RmsPx(), 2);
      count += n;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

Eigen::MatrixXd StereoSolution::Covariance() const {
  return noise_px * noise_px * InverseOf(normal_matrix);
}

Baseline BaselineOf(const Pose& T_C0C1, const Eigen::Matrix3d& covariance_p) {
  const Eigen::Vector3d along = T_C0C1.p.normalized();
  return {T_C0C1.p.norm(), std::sqrt(along.dot(covariance_p * along))};
}

}  // namespace flextip
