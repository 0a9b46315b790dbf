#include "estimation/moment_fit.h"

#include <algorithm>
#include <cmath>

#include "core/rotation.h"

namespace flextip {
namespace {

bool IsSound(const MomentPair& m, double EI, double L) {
  return m.m1_Nm.allFinite() && m.m2_Nm.allFinite() && std::isfinite(m.noise_Nm) &&
         std::isfinite(EI) && std::isfinite(L) && EI > 0 && L > 0 && m.station1_m > 0 &&
         m.station1_m < m.station2_m && m.station2_m < L;
}

}  // namespace

BeamFit FitFromMoments(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                       const MomentPair& moments, double bending_stiffness_Nm2, double length_m,
                       double significance) noexcept {
  BeamFit fit;
  const Eigen::Vector3d chord = p_RE - p_RW;
  const double distance = chord.norm(), L = length_m, EI = bending_stiffness_Nm2;
  if (!IsSound(moments, EI, L) || !std::isfinite(distance) || distance <= 0) return fit;
  fit.length_m = L;
  const Eigen::Vector3d v_x = chord / distance;
  fit.R_RM << v_x, NormalBasis(v_x);

  // (4) on either side of the port: M / x is the wrist's force, M / (L - x) the tip's, over which
  // (5) and (6) are a = L F_t / F_p and F_p = F_w + F_t. Here as vectors F v_z, over EI.
  const double arm1 = moments.station1_m * EI, arm2 = (L - moments.station2_m) * EI;
  const auto across = [&](const Eigen::Vector3d& m) -> Eigen::Vector3d {
    return m - m.dot(v_x) * v_x;
  };
  const Eigen::Vector3d F_wrist = across(moments.m1_Nm) / arm1;
  const Eigen::Vector3d F_tip = across(moments.m2_Nm) / arm2;
  const Eigen::Vector3d F_port = F_wrist + F_tip;
  const double var_wrist = std::pow(moments.noise_Nm / arm1, 2);
  const double var_tip = std::pow(moments.noise_Nm / arm2, 2);
  const double F = F_port.norm(), sd = std::sqrt(var_wrist + var_tip);
  if (F <= std::max(1e-12 / (L * L), significance * sd)) {
    return StraightFit(fit.R_RM, L, sd * sd);
  }
  const Eigen::Vector3d v_z = -F_port / F;  // so that F_p <= 0, as from slopes
  fit.R_RM.col(1) = v_z.cross(v_x);
  fit.R_RM.col(2) = v_z;
  const double F_w = -F_wrist.dot(v_z), F_t = -F_tip.dot(v_z);
  const double a = L * F_t / F;
  fit.status = BeamStatus::kNoPort;
  if (!(a > std::max(moments.station1_m, kPortMargin * L) &&
        a < std::min(moments.station2_m, (1.0 - kPortMargin) * L))) {
    return fit;
  }
  fit.status = BeamStatus::kOk;
  fit.F_p_over_EI = -F;
  fit.a = a;
  Eigen::Matrix2d J;  // d (F_p/EI, a) / d (F_w, F_t)
  J << -1.0, -1.0, -L * F_t / (F * F), L * F_w / (F * F);
  fit.covariance = J * Eigen::Vector2d(var_wrist, var_tip).asDiagonal() * J.transpose();
  return fit;
}

}  // namespace flextip
