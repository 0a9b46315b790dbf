#include "calibration/tip/pivot_fit.h"

#include <algorithm>
#include <cmath>

#include "calibration/residual_statistics.h"
#include "core/linear_algebra.h"
#include "core/median.h"
#include "core/rotation.h"

namespace flextip {
namespace {

using Jacobian = Eigen::Matrix<double, 3, 6>;

Jacobian ErrorJacobian(const PivotPose& pose) {
  Jacobian J;
  J << pose.T_RB.R, -Eigen::Matrix3d::Identity();
  return J;
}

/// From B's origin to the tip, halfway between where the measured orientation and where the pivot
/// puts it: the error that a turn makes is across this to second order, across R x to first only.
Eigen::Vector3d LeverOf(const PivotPose& pose, const PivotPoint& point) {
  return pose.T_RB.R * point.x_B - 0.5 * PivotError(pose, point);
}

/// The part of the error's covariance that each kind of noise makes, as stated.
struct NoiseParts {
  Eigen::Matrix3d orientation, position, cross;
};
NoiseParts PartsOf(const PivotPose& pose, const PivotPoint& point) {
  const Eigen::Matrix3d A = -Skew(LeverOf(pose, point));
  const Matrix6d& C = pose.covariance;
  const Eigen::Matrix3d cross = A * C.topRightCorner<3, 3>();
  return {A * C.topLeftCorner<3, 3>() * A.transpose(), C.bottomRightCorner<3, 3>(),
          cross + cross.transpose()};
}
Eigen::Matrix3d Sum(const NoiseParts& parts, const PivotPoint& point) {
  return point.orientation_factor * parts.orientation + point.position_factor * parts.position +
         std::sqrt(point.orientation_factor * point.position_factor) * parts.cross;
}

/// How much d(error covariance)/dx takes off the gradient of the squared error.
Eigen::Vector3d LeverGradient(const PivotPose& pose, const PivotPoint& point,
                              const Eigen::Vector3d& v) {
  const Eigen::Matrix3d& R = pose.T_RB.R;
  const Eigen::Matrix3d A = -Skew(LeverOf(pose, point));
  const double both = std::sqrt(point.orientation_factor * point.position_factor);
  const Eigen::Vector3d h =
      point.orientation_factor * pose.covariance.topLeftCorner<3, 3>() * (A.transpose() * v) +
      both * pose.covariance.topRightCorner<3, 3>() * v;
  // v^T (-[R e_j]x) h = (R e_j) . (v x h)
  return R.transpose() * v.cross(h);
}

Vector6d LikelihoodStep(const std::vector<PivotPose>& poses, const std::vector<double>& weights,
                        const PivotPoint& point) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const Jacobian J = ErrorJacobian(poses[i]);
    const Eigen::Matrix3d W = PivotErrorCovariance(poses[i], point).inverse();
    const Eigen::Vector3d v = W * PivotError(poses[i], point);
    H += weights[i] * J.transpose() * W * J;
    g += weights[i] * J.transpose() * v;
    g.head<3>() -= weights[i] * LeverGradient(poses[i], point, v);
  }
  return -CompleteOrthogonal(H).Solve(g);
}

/// One step of the multiplicative iteration for variance components: what the residuals show of
/// each over what would be expected. Its fixed point is the restricted maximum likelihood.
void UpdateNoise(const std::vector<PivotPose>& poses, const std::vector<double>& weights,
                 bool separate_noise, PivotPoint& point) {
  const Matrix6d C = CompleteOrthogonal(PivotInformation(poses, weights, point)).PseudoInverse();
  Eigen::Vector2d found = Eigen::Vector2d::Zero(), expected = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const NoiseParts parts = PartsOf(poses[i], point);
    const Eigen::Matrix3d S = Sum(parts, point), W = S.inverse();
    const Jacobian J = ErrorJacobian(poses[i]);
    const Eigen::Matrix3d P = W - W * J * C * J.transpose() * W;
    const Eigen::Vector3d v = W * PivotError(poses[i], point);
    const Eigen::Matrix3d V[2] = {separate_noise ? parts.orientation : S, parts.position};
    for (int k = 0; k < 2; ++k) {
      found[k] += weights[i] * v.dot(V[k] * v);
      expected[k] += weights[i] * (P * V[k]).trace();
    }
  }
  const auto ratio = [&](int k) {
    return expected[k] > 0 && found[k] > 0 ? std::clamp(found[k] / expected[k], 0.1, 10.0) : 1.0;
  };
  constexpr double kLeast = 1e-6;  // a kind of noise that is not there stays above zero
  point.orientation_factor = std::max(kLeast, point.orientation_factor * ratio(0));
  point.position_factor = std::max(kLeast, point.position_factor * ratio(separate_noise ? 1 : 0));
}

}  // namespace

Eigen::Vector3d PivotError(const PivotPose& pose, const PivotPoint& point) {
  return pose.T_RB * point.x_B - point.p_R;
}

Eigen::Matrix3d PivotErrorCovariance(const PivotPose& pose, const PivotPoint& point) {
  return Sum(PartsOf(pose, point), point);
}

double PivotSigmas(const PivotPose& pose, const PivotPoint& point) {
  const Eigen::Vector3d r = PivotError(pose, point);
  return std::sqrt(r.dot(Llt(PivotErrorCovariance(pose, point)).Solve(r)));
}

Matrix6d PivotInformation(const std::vector<PivotPose>& poses, const std::vector<double>& weights,
                          const PivotPoint& point) {
  Matrix6d H = Matrix6d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const Jacobian J = ErrorJacobian(poses[i]);
    H += weights[i] * J.transpose() * Llt(PivotErrorCovariance(poses[i], point)).Solve(J);
  }
  return H;
}

PivotPoint AlgebraicPivot(const std::vector<PivotPose>& poses, const std::vector<double>& weights) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Jacobian J = ErrorJacobian(poses[i]);
    H += weights[i] * J.transpose() * J;
    g -= weights[i] * J.transpose() * poses[i].T_RB.p;
  }
  const Vector6d x = CompleteOrthogonal(H).Solve(g);
  return {.x_B = x.head<3>(), .p_R = x.tail<3>()};
}

PivotPoint RobustPivot(const std::vector<PivotPose>& poses, const PivotPoint& start) {
  constexpr int kIterations = 30;
  PivotPoint point = start;
  std::vector<double> weights(poses.size(), 1.0), sigmas(poses.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t i = 0; i < poses.size(); ++i) sigmas[i] = PivotSigmas(poses[i], point);
    const double least = 0.1 * std::max(1e-12, Median(sigmas));
    for (std::size_t i = 0; i < poses.size(); ++i) weights[i] = least / std::max(least, sigmas[i]);
    const PivotPoint next = AlgebraicPivot(poses, weights);
    point.x_B = next.x_B;
    point.p_R = next.p_R;
  }
  for (std::size_t i = 0; i < poses.size(); ++i) sigmas[i] = PivotSigmas(poses[i], point);
  const double scale = std::max(1e-6, RobustScale(sigmas));
  point.orientation_factor = point.position_factor = scale * scale;
  return point;
}

PivotPoint LikelyPivot(const std::vector<PivotPose>& poses, const std::vector<double>& weights,
                       const PivotPoint& start, PivotNoise noise) {
  constexpr int kIterations = 100;
  PivotPoint point = start;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Vector6d step = LikelihoodStep(poses, weights, point);
    point.x_B += step.head<3>();
    point.p_R += step.tail<3>();
    const PivotPoint before = point;
    if (noise != PivotNoise::kKept) {
      UpdateNoise(poses, weights, noise == PivotNoise::kTwoFactors, point);
    }
    const double change = std::abs(std::log(point.position_factor / before.position_factor)) +
                          std::abs(std::log(point.orientation_factor / before.orientation_factor));
    if (step.norm() < 1e-9 && change < 1e-4) break;
  }
  return point;
}

}  // namespace flextip
