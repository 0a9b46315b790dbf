// The shaft's free end beyond a rigid collar of tags: the true place of its tip.
#pragma once

#include <Eigen/Dense>

#include "core/instrument.h"
#include "core/pose.h"
#include "core/tag_collar.h"

namespace flextip {

/// A free end, clamped in the collar.
struct FreeEnd {
  double length_m = 0.0;
  double bending_stiffness_Nm2 = 1.0;
  Eigen::Vector3d weight_N_m = Eigen::Vector3d::Zero();  ///< per length, in R
};

/// Returns the length of the tip beyond a collar's tags, along E's x axis (m). The collar is rigid
/// as far as its tags reach.
double FreeLength(const TagCollar& collar);

/// Returns the part of the shaft beyond the collar. A stiffness that tapers counts by its value
/// where a load on the tip bends the end most: a quarter of the end's length beyond the collar.
FreeEnd FreeEndOf(const Instrument& instrument, const TagCollar& collar,
                  const Eigen::Vector3d& gravity_m_s2);

/// Returns the tip's pose in R, where the collar, taken for rigid up to the tip, has the tip at
/// `T_RE`. `f_tip_N` is in R. The end is a cantilever to first order in its slope (Euler and
/// Bernoulli; 0.4 % of the deflection at 0.1 rad). Forces along the shaft do nothing.
Pose BendFreeEnd(const FreeEnd& end, const Eigen::Vector3d& f_tip_N, const Pose& T_RE);

/// Returns the tip's move for each newton across the shaft (m/N).
inline double FreeEndCompliance(const FreeEnd& end) {
  return end.length_m * end.length_m * end.length_m / (3 * end.bending_stiffness_Nm2);
}

}  // namespace flextip
