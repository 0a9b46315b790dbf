// The load on the tip: a constant force, soft tissue with a surface, a law of its own, or all.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>

namespace flextip::simulation {

/// Soft tissue behind a plane. Its force on a tip at depth d below the surface is, along the
/// outward normal, `stiffness_N_m` times d, with a quadratic onset over the first `onset_m` so that
/// force and stiffness are continuous; and, where `tangential_stiffness_N_m` is not zero, a spring
/// along the surface toward `p_anchor`, which sets in with the same onset.
struct Tissue {
  Eigen::Vector3d p_surface = Eigen::Vector3d::Zero();  ///< a point on the surface, in R
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();    ///< unit, out of the tissue, in R
  double stiffness_N_m = 0.0;
  double tangential_stiffness_N_m = 0.0;
  Eigen::Vector3d p_anchor = Eigen::Vector3d::Zero();  ///< where the surface was touched
  double onset_m = 1e-3;                               ///< positive
};

/// A force on the tip and how it changes with the tip's position.
struct LinearTipForce {
  Eigen::Vector3d f_N = Eigen::Vector3d::Zero();
  Eigen::Matrix3d df_dp_N_m = Eigen::Matrix3d::Zero();
};

/// The whole load on the tip, everything in R.
struct TipLoad {
  Eigen::Vector3d constant_N = Eigen::Vector3d::Zero();
  std::optional<Tissue> tissue;
  /// Any other law, continuous in the tip's position (soft_cylinder.h); empty: none.
  std::function<LinearTipForce(const Eigen::Vector3d& p_tip)> other = {};

  LinearTipForce At(const Eigen::Vector3d& p_tip) const;
};

}  // namespace flextip::simulation
