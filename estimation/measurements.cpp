#include "estimation/measurements.h"

#include <cmath>

#include "core/linear_algebra.h"
#include "core/place.h"

namespace flextip {
namespace {

constexpr double kMostMoment_Nm = 1e6, kMostForce_N = 1e6;
constexpr double kMostNoise = 1e6;  // in any unit: a sensor that says nothing
constexpr double kUnit = 0.01;      // of a direction's length, of a rotation

/// False for what is not a number, too.
bool IsNoise(double sd) { return sd >= 0.0 && sd <= kMostNoise; }

bool IsDirection(const Eigen::Vector3d& d) { return std::abs(d.norm() - 1.0) <= kUnit; }

bool IsRotation(const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d rest = R.transpose() * R - Eigen::Matrix3d::Identity();
  return rest.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kUnit && R.determinant() > 0.0;
}

template <class V>
bool IsSmall(const Eigen::MatrixBase<V>& v, double most) {
  return v.cwiseAbs().template maxCoeff<Eigen::PropagateNaN>() <= most;
}

/// Zero is one: of noise-free data.
bool IsCovariance(const Eigen::Matrix3d& C) {
  constexpr double kRounding = 1e-9;
  if (!IsSmall(C, kMostNoise * kMostNoise)) return false;
  const double most = C.cwiseAbs().maxCoeff();
  return IsSmall(C - C.transpose(), kRounding * most) &&
         SymmetricEigenvalues(C)[0] >= -kRounding * most;
}

bool IsPlausible(const TipObservation& tip, double direction_noise_rad) {
  return IsPlace(tip.p_RE) && IsCovariance(tip.covariance_m2) &&
         (!tip.d_RE || (IsDirection(*tip.d_RE) && IsNoise(direction_noise_rad)));
}

bool IsPlausible(const EmMeasurement& em) {
  return IsPlace(em.T_RS.p) && IsRotation(em.T_RS.R) && em.distance_from_tip_m >= 0.0 &&
         em.distance_from_tip_m <= kFarthestPlace_m && IsNoise(em.position_noise_m) &&
         IsNoise(em.orientation_noise_rad);
}

bool IsPlausible(const StrainMeasurement& strain) {
  for (const double s_m : strain.station_from_wrist_m) {
    if (!(s_m >= 0.0 && s_m <= kFarthestPlace_m)) return false;
  }
  return IsSmall(strain.moments_Nm, kMostMoment_Nm) && IsNoise(strain.moment_noise_Nm);
}

}  // namespace

bool IsPlausible(const Measurements& z) {
  if (!IsPlace(z.p_RW) || !IsNoise(z.wrist_position_noise_m)) return false;
  if (z.R_RW && !(IsRotation(*z.R_RW) && IsNoise(z.wrist_orientation_noise_rad))) return false;
  if (z.tip && z.tip->status != TipStatus::kLost &&
      !IsPlausible(*z.tip, z.tip_direction_noise_rad)) {
    return false;
  }
  if (z.em && !IsPlausible(*z.em)) return false;
  if (z.port_direction &&
      !(IsDirection(*z.port_direction) && IsNoise(z.port_direction_noise_rad))) {
    return false;
  }
  if (z.strain && !IsPlausible(*z.strain)) return false;
  return !z.load || (IsSmall(z.load->f_tip_N, kMostForce_N) && IsNoise(z.load->force_noise_N));
}

}  // namespace flextip
