// The thesis's beam from bending moments at two stations, one each side of the port (4)-(6), in
// 3-D. Allocates nothing.
#pragma once

#include <Eigen/Dense>

#include "estimation/measurements.h"
#include "estimation/slope_fit.h"
#include "kinematics/beam.h"

namespace flextip {

/// Bending moments of the part beyond on the part before, in R.
struct MomentPair {
  Eigen::Vector3d m1_Nm = Eigen::Vector3d::Zero();  ///< between wrist and port
  Eigen::Vector3d m2_Nm = Eigen::Vector3d::Zero();  ///< between port and tip
  double station1_m = 0.0, station2_m = 0.0;        ///< from the wrist
  double noise_Nm = 0.0;                            ///< standard deviation per axis
};

/// A moment given about the local section's y and z axes (the wrist frame carried along the shaft
/// without twist) as a vector in R. Exact at every station for a shaft bent in one plane: bending
/// turns the section about the moment's own axis.
inline Eigen::Vector3d MomentInR(const Eigen::Matrix3d& R_RW, double m_y, double m_z) noexcept {
  return R_RW.col(1) * m_y + R_RW.col(2) * m_z;
}

/// The gages' moments in R, as MomentInR has them.
inline MomentPair MomentsInR(const StrainMeasurement& strain, const Eigen::Matrix3d& R_RW) {
  const Eigen::Vector4d& m = strain.moments_Nm;
  return {MomentInR(R_RW, m[0], m[1]), MomentInR(R_RW, m[2], m[3]), strain.station_from_wrist_m[0],
          strain.station_from_wrist_m[1], strain.moment_noise_Nm};
}

/// The beam with its chord from `p_RW` to `p_RE` (m, in R). The moments' parts along the chord are
/// ignored. kStraight: no moment beyond `significance` standard deviations. kNoPort: the moments
/// put the port outside the two stations.
BeamFit FitFromMoments(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RE,
                       const MomentPair& moments, double bending_stiffness_Nm2, double length_m,
                       double significance = kBendSignificance) noexcept;

}  // namespace flextip
