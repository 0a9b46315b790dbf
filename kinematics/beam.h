// The thesis's beam: pinned at both ends, a point load at the port (3.1)-(3.14), with a Jacobian
// that a finite difference confirms (docs/errata.md). Model frame M: wrist at the origin, x to the
// tip, the shaft in the x-y plane.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

namespace flextip {

/// Which load a flexion Jacobian holds constant while the wrist moves.
enum class BeamLoadLaw : std::uint8_t {
  kPortForce,  ///< F_p, as the thesis assumes (3.2.2)
  kTipForce,   ///< F_t = F_p a / L: a hung mass, soft tissue
};

enum class BeamStatus : std::uint8_t {
  kOk,
  kStraight,      ///< no flexion to be seen: `a` is not observable, the beam is a straight line
  kBadInput,      ///< not finite, or lengths that are not positive
  kNoPort,        ///< no port between wrist and tip fits: the measurements contradict the beam
};

/// A beam fitted to measurements, in R.
struct BeamFit {
  BeamStatus status = BeamStatus::kBadInput;
  double F_p_over_EI = 0.0;                                ///< 1/m^2, along -y_M where positive (3.1)
  double a = 0.0;                                          ///< port's place along x_M (m)
  double length_m = 0.0;
  Eigen::Matrix3d R_RM = Eigen::Matrix3d::Identity();      ///< columns v_x, v_y, v_z (5.29)
  /// Of (F_p/EI, a), from the stated noise; zero where no noise was stated.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

}  // namespace flextip
