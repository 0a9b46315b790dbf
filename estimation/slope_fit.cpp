#include "estimation/slope_fit.h"

#include <algorithm>
#include <cmath>

#include "core/rotation.h"

namespace flextip {
namespace {

// Rounding alone tilts directions by this much; no bending below it is believed.
constexpr double kLeastBend_rad = 1e-9;

// d (F_p/EI, a) / d (y'(0), y'(L)) of (3.11), (3.12), with d = y'(L) - y'(0), F = 2 d / (a b).
Eigen::Matrix2d ClosedFormJacobian(double y_wrist, double y_tip, double a, double L) {
  const double d = y_tip - y_wrist, n = 2.0 * y_tip + y_wrist, b = L - a, ab = a * b;
  const Eigen::RowVector2d dd(-1.0, 1.0);
  const Eigen::RowVector2d da = L / d * Eigen::RowVector2d(1.0, 2.0) - L * n / (d * d) * dd;
  Eigen::Matrix2d J;
  J << 2.0 / ab * dd - 2.0 * d * (b - a) / (ab * ab) * da, da;
  return J;
}

}  // namespace

BeamFit StraightFit(const Eigen::Matrix3d& R_RM, double length_m, double F_variance) noexcept {
  BeamFit fit;
  fit.status = BeamStatus::kStraight;
  fit.a = 0.5 * length_m;
  fit.length_m = length_m;
  fit.R_RM = R_RM;
  fit.covariance << F_variance, 0.0, 0.0, length_m * length_m / 12.0;
  return fit;
}

BeamSlopes MeasureSlopes(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                         const Eigen::Vector3d& t_wrist, const Eigen::Vector3d& t_tip,
                         const SlopeNoise& noise, double significance) noexcept {
  BeamSlopes slopes;
  const Eigen::Vector3d chord = p_RE - p_RW;
  const double distance = chord.norm(), n_wrist = t_wrist.norm(), n_tip = t_tip.norm();
  const double bend_noise = std::hypot(noise.wrist_rad, noise.tip_rad);  // the chord's drops out
  if (!std::isfinite(distance + n_wrist + n_tip + bend_noise + noise.chord_rad) || distance <= 0 ||
      n_wrist <= 0 || n_tip <= 0) {
    return slopes;
  }
  const Eigen::Vector3d v_x = chord / distance;  // (5.4)
  const Eigen::Vector3d k_wrist = t_wrist / n_wrist, k_tip = t_tip / n_tip;
  slopes.R_RM << v_x, NormalBasis(v_x);
  if (k_wrist.dot(v_x) <= 0 || k_tip.dot(v_x) <= 0) {
    slopes.status = BeamStatus::kNoPort;
    return slopes;
  }
  Eigen::Vector3d bend = k_wrist - k_tip;
  bend -= bend.dot(v_x) * v_x;
  if (bend.norm() <= std::max(kLeastBend_rad, significance * bend_noise)) {
    slopes.status = BeamStatus::kStraight;
    return slopes;
  }
  slopes.R_RM.col(1) = bend.normalized();
  slopes.R_RM.col(2) = v_x.cross(slopes.R_RM.col(1));                 // (5.5)
  slopes.wrist = slopes.R_RM.col(1).dot(k_wrist) / v_x.dot(k_wrist);  // (5.8)
  slopes.tip = slopes.R_RM.col(1).dot(k_tip) / v_x.dot(k_tip);        // (5.9)
  slopes.status = BeamStatus::kOk;
  return slopes;
}

BeamFit FitFromSlopes(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                      const Eigen::Vector3d& t_wrist, const Eigen::Vector3d& t_tip, double length_m,
                      const SlopeNoise& noise, double significance) noexcept {
  BeamFit fit;
  if (!std::isfinite(length_m) || length_m <= 0) return fit;
  const BeamSlopes slopes = MeasureSlopes(p_RW, p_RE, t_wrist, t_tip, noise, significance);
  const double L = length_m;
  fit.status = slopes.status;
  fit.length_m = L;
  fit.R_RM = slopes.R_RM;
  const double var_wrist = noise.wrist_rad * noise.wrist_rad;
  const double var_tip = noise.tip_rad * noise.tip_rad;
  if (slopes.status == BeamStatus::kStraight) {
    return StraightFit(slopes.R_RM, L, std::pow(8.0 / (L * L), 2) * (var_wrist + var_tip));
  }
  if (slopes.status != BeamStatus::kOk) return fit;

  const double y_wrist = slopes.wrist, y_tip = slopes.tip;
  const double a = L * (2.0 * y_tip + y_wrist) / (y_tip - y_wrist);  // (5.12)
  if (!(a > kPortMargin * L && a < (1.0 - kPortMargin) * L)) {
    fit.status = BeamStatus::kNoPort;
    return fit;
  }
  fit.a = a;
  fit.F_p_over_EI = 2.0 * (y_wrist - y_tip) / (a * (a - L));  // (5.11)
  // A slope is the tangent of the angle between direction and chord.
  const Eigen::Vector2d rate(1.0 + y_wrist * y_wrist, 1.0 + y_tip * y_tip);
  Eigen::Matrix2d slope_covariance = rate * rate.transpose() * noise.chord_rad * noise.chord_rad;
  slope_covariance(0, 0) += rate[0] * rate[0] * var_wrist;
  slope_covariance(1, 1) += rate[1] * rate[1] * var_tip;
  const Eigen::Matrix2d J = ClosedFormJacobian(y_wrist, y_tip, a, L);
  fit.covariance = J * slope_covariance * J.transpose();
  return fit;
}

}  // namespace flextip
