#include "simulation/tissue/tip_load.h"

namespace flextip::simulation {
namespace {

/// A smooth onset: 0 above the surface, d^2 / 2w down to w, d - w/2 below; with two derivatives.
struct Ramp {
  double value = 0.0, slope = 0.0, curvature = 0.0;
};

Ramp RampAt(double depth, double onset) {
  if (depth <= 0) return {};
  if (depth < onset) return {0.5 * depth * depth / onset, depth / onset, 1.0 / onset};
  return {depth - 0.5 * onset, 1.0, 0.0};
}

LinearTipForce TissueForce(const Tissue& tissue, const Eigen::Vector3d& p_tip) {
  const Eigen::Vector3d& n = tissue.normal;
  const Ramp ramp = RampAt(-n.dot(p_tip - tissue.p_surface), tissue.onset_m);
  const Eigen::Matrix3d along = Eigen::Matrix3d::Identity() - n * n.transpose();
  const Eigen::Vector3d pulled = along * (p_tip - tissue.p_anchor);
  LinearTipForce force;
  force.f_N =
      tissue.stiffness_N_m * ramp.value * n - tissue.tangential_stiffness_N_m * ramp.slope * pulled;
  force.df_dp_N_m = -tissue.stiffness_N_m * ramp.slope * n * n.transpose() -
                    tissue.tangential_stiffness_N_m *
                        (ramp.slope * along - ramp.curvature * pulled * n.transpose());
  return force;
}

}  // namespace

LinearTipForce TipLoad::At(const Eigen::Vector3d& p_tip) const {
  LinearTipForce force = tissue ? TissueForce(*tissue, p_tip) : LinearTipForce{};
  force.f_N += constant_N;
  if (other) {
    const LinearTipForce more = other(p_tip);
    force.f_N += more.f_N;
    force.df_dp_N_m += more.df_dp_N_m;
  }
  return force;
}

}  // namespace flextip::simulation
