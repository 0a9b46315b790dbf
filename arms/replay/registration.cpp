#include "arms/replay/registration.h"

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& M) {
  const Svd svd(M);
  Eigen::Matrix3d turn = svd.U * svd.V.transpose();
  if (turn.determinant() < 0.0) {
    Eigen::Matrix3d U = svd.U;
    U.col(2) *= -1.0;
    turn = U * svd.V.transpose();
  }
  return turn;
}

/// Rotations X, Y with X arm Y = seen: X^T seen - arm Y = 0, linear in both.
std::optional<std::pair<Eigen::Matrix3d, Eigen::Matrix3d>> FindRotations(
    const std::vector<Pose>& arm, const std::vector<Pose>& seen) {
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(18, 18);
  for (std::size_t k = 0; k < arm.size(); ++k) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(9, 18);  // unknowns: Z = X^T, then Y, by columns
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int m = 0; m < 3; ++m) {
          rows(3 * i + j, 3 * m + i) += seen[k].R(m, j);
          rows(3 * i + j, 9 + 3 * j + m) -= arm[k].R(i, m);
        }
    N += rows.transpose() * rows;
  }
  const SymmetricEigen eigen(N);
  const double n = double(arm.size());
  if (eigen.values[1] < 1e-4 * n) return {};  // a second answer: the arm hardly turned
  Eigen::Matrix3d Z = Eigen::Map<const Eigen::Matrix3d>(eigen.vectors.col(0).data());
  Eigen::Matrix3d Y = Eigen::Map<const Eigen::Matrix3d>(eigen.vectors.col(0).data() + 9);
  if (Z.determinant() < 0.0) {
    Z = -Z;
    Y = -Y;
  }
  return std::pair{NearestRotation(Z.transpose()), NearestRotation(Y)};
}

}  // namespace

std::optional<Pose> FindTracker(const std::vector<Eigen::Vector3d>& arm,
                                const std::vector<Eigen::Vector3d>& seen) {
  if (arm.size() < 3) return {};
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), s = a;
  for (std::size_t k = 0; k < arm.size(); ++k) {
    a += arm[k] / double(arm.size());
    s += seen[k] / double(arm.size());
  }
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < arm.size(); ++k) M += (seen[k] - s) * (arm[k] - a).transpose();
  if (Svd<3>::Values(M)[1] <= 1e-12) return {};  // points in a line
  const Eigen::Matrix3d R = NearestRotation(M);
  return Pose{R, s - R * a};
}

std::optional<Places> FindPlaces(const std::vector<Pose>& arm, const std::vector<Pose>& seen,
                                 bool marker_unknown, const Pose& T_LK) {
  if (arm.size() < 3) return {};
  if (!marker_unknown) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < arm.size(); ++k) sum += seen[k].R * (arm[k].R * T_LK.R).transpose();
    Places places{{NearestRotation(sum), Eigen::Vector3d::Zero()}, T_LK};
    for (std::size_t k = 0; k < arm.size(); ++k)
      places.T_TR.p += (seen[k].p - places.T_TR.R * (arm[k] * T_LK.p)) / double(arm.size());
    return places;
  }
  const auto rotations = FindRotations(arm, seen);
  if (!rotations) return {};
  const auto& [X, Y] = *rotations;
  Eigen::Matrix<double, 6, 6> N = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t k = 0; k < arm.size(); ++k) {
    Eigen::Matrix<double, 3, 6> rows;
    rows << Eigen::Matrix3d::Identity(), X * arm[k].R;
    N += rows.transpose() * rows;
    g += rows.transpose() * (seen[k].p - X * arm[k].p);
  }
  const Eigen::Matrix<double, 6, 1> t = Ldlt(N).Solve(g);
  return Places{{X, t.head<3>()}, {Y, t.tail<3>()}};
}

}  // namespace flextip::arms
