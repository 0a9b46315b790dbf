#include "kinematics/tip_bending.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/rotation.h"

namespace flextip {

double FreeLength(const TagCollar& collar) {
  double reach_m = -HUGE_VAL;  // along E's x axis
  for (const CollarTag& tag : collar.tags) {
    const double half_m = 0.5 * tag.size_m * tag.T_EG.R.row(0).head<2>().lpNorm<1>();
    reach_m = std::max(reach_m, tag.T_EG.p.x() + half_m);
  }
  return std::max(0.0, -reach_m);
}

FreeEnd FreeEndOf(const Instrument& instrument, const TagCollar& collar,
                  const Eigen::Vector3d& gravity_m_s2) {
  const double free_m = FreeLength(collar);
  return {free_m, instrument.StiffnessAt(instrument.length_m - 0.75 * free_m),
          instrument.mass_per_length_kg_m * gravity_m_s2};
}

Pose BendFreeEnd(const FreeEnd& end, const Eigen::Vector3d& f_tip_N, const Pose& T_RE) {
  assert(end.length_m >= 0 && end.bending_stiffness_Nm2 > 0);
  const double l = end.length_m, EI = end.bending_stiffness_Nm2;
  const Eigen::Vector3d d = T_RE.R.col(0);
  const auto across = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d { return v - v.dot(d) * d; };
  const Eigen::Vector3d f = across(f_tip_N), q = across(end.weight_N_m);
  const Eigen::Vector3d deflection = l * l * l / EI * (f / 3 + l * q / 8);
  const Eigen::Vector3d slope = l * l / EI * (f / 2 + l * q / 6);
  return {ExpRotation(d.cross(slope)) * T_RE.R, T_RE.p + deflection};
}

}  // namespace flextip
