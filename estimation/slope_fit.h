// The thesis's beam from the shaft's directions at wrist and tip: closed form (3.11), (3.12), in
// 3-D by (5.4)-(5.12). Allocates nothing.
#pragma once

#include <Eigen/Dense>

#include "kinematics/beam.h"

namespace flextip {

/// Standard deviations of measured directions, per axis across the shaft. The chord from wrist to
/// tip has its own: the noise of the two positions, added in squares, over their distance.
struct SlopeNoise {
  double wrist_rad = 0.0;
  double port_rad = 0.0;  ///< used by the three-slope fit only
  double tip_rad = 0.0;
  double chord_rad = 0.0;
};

/// How many standard deviations bending must stand out from its noise before a port is inferred
/// from it. Below, a fit says kStraight.
inline constexpr double kBendSignificance = 5.0;

/// A port nearer either end than this part of the length is not accepted: force and Jacobian go to
/// infinity there.
inline constexpr double kPortMargin = 0.01;

/// Directions turned into slopes in the plane of bending.
struct BeamSlopes {
  BeamStatus status = BeamStatus::kBadInput;
  Eigen::Matrix3d R_RM = Eigen::Matrix3d::Identity();
  double wrist = 0.0, tip = 0.0;  ///< y' (5.8), (5.9)
};

/// Registers the model frame (5.4)-(5.10). v_y follows the difference of the two directions where
/// the thesis takes the wrist's alone (5.5): the same without noise, steadier with it.
/// kStraight: the difference is within `significance` standard deviations of zero. kNoPort: a
/// direction points back along the chord.
BeamSlopes MeasureSlopes(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                         const Eigen::Vector3d& t_wrist, const Eigen::Vector3d& t_tip,
                         const SlopeNoise& noise, double significance = kBendSignificance) noexcept;

/// The beam through wrist `p_RW` and tip `p_RE` (m, in R) with the shaft's directions there (any
/// length; in R). kStraight: no bending beyond the noise, F_p = 0, `a` means nothing (half the
/// length, with the variance of a port anywhere on the shaft). kNoPort: bent, but not as a beam
/// with a port between wrist and tip.
BeamFit FitFromSlopes(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                      const Eigen::Vector3d& t_wrist, const Eigen::Vector3d& t_tip, double length_m,
                      const SlopeNoise& noise, double significance = kBendSignificance) noexcept;

/// The fit handed out where there is no significant bending; `F_variance` is of F_p/EI at a port
/// half way.
BeamFit StraightFit(const Eigen::Matrix3d& R_RM, double length_m, double F_variance) noexcept;

}  // namespace flextip
