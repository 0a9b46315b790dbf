#include "calibration/camera/solution.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

// Of a matrix with a diagonal of ones; below this the inverse has no digit left that means
// anything.
constexpr double kSmallestPivot = 1e-14;

}  // namespace

int SolvedView::CountUsed() const {
  return static_cast<int>(
      std::count_if(reason.begin(), reason.end(), [](const auto& r) { return r.empty(); }));
}

double SolvedView::RmsPx(bool with_outliers) const {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < residual_px.size(); ++i) {
    if (!with_outliers && !IsUsed(i)) continue;
    sum += residual_px[i].squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

int CameraSolution::CornersUsed() const {
  int count = 0;
  for (const SolvedView& view : views) count += view.CountUsed();
  return count;
}

int CameraSolution::Outliers() const {
  int count = 0;
  for (const SolvedView& view : views) count += static_cast<int>(view.px.size());
  return count - CornersUsed();
}

double CameraSolution::RmsPx(bool with_outliers) const {
  double sum = 0.0, count = 0.0;
  for (const SolvedView& view : views) {
    const double n = with_outliers ? static_cast<double>(view.px.size()) : view.CountUsed();
    sum += n * std::pow(view.RmsPx(with_outliers), 2);
    count += n;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

Eigen::MatrixXd CameraSolution::Covariance() const {
  return noise_px * noise_px * InverseOf(normal_matrix);
}

Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& normal_matrix) {
  const Eigen::VectorXd diagonal = normal_matrix.diagonal();
  if (diagonal.size() == 0 || diagonal.minCoeff() <= 0) return {};
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * normal_matrix * scale.asDiagonal();
  const Ldlt ldlt(unit);
  if (!ldlt.Succeeded() || ldlt.Pivots().minCoeff() < kSmallestPivot) return {};
  const Eigen::MatrixXd inverse = scale.asDiagonal() * ldlt.Inverse() * scale.asDiagonal();
  return 0.5 * (inverse + inverse.transpose());
}

}  // namespace flextip
