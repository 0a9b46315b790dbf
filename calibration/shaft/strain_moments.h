// The bending moments that a known load causes where the strain gages are, by the exact rod.
#pragma once

#include <Eigen/Dense>

#include "calibration/shaft/known_loads.h"
#include "core/instrument.h"
#include "kinematics/effect_rod.h"

namespace flextip {

/// Moments m1_y, m1_z, m2_y, m2_z (Nm) as strain0 has them (docs/formats.md), and how they change.
struct StatedMoments {
  Eigen::Vector4d m_Nm = Eigen::Vector4d::Zero();
  Eigen::Matrix<double, 4, 3> by_wrist, by_port, by_force;
  Eigen::Vector4d by_roll;  ///< of the instrument about its axis
  double s_port_m = 0.0;

  /// Returns the covariance ((Nm)^2) by the errors of load, wrist and roll. The port is common to
  /// all holds, and not in it.
  Eigen::Matrix4d Covariance(const LoadHold& hold) const;
};

class MomentModel {
 public:
  /// Takes `stations_m` from the wrist, within the shaft.
  MomentModel(const Instrument& instrument, const Eigen::Vector3d& p_RP,
              const Eigen::Vector3d& gravity_m_s2, const double (&stations_m)[2]);

  /// Returns the moments in `hold`. Empty where the rod has no equilibrium or the wrist's
  /// orientation is not known.
  std::optional<StatedMoments> At(const LoadHold& hold);

 private:
  EffectRodProblem problem_;
  RodStation stations_[2];
  EffectRodSolver solver_;
};

}  // namespace flextip
