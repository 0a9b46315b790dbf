// The thesis's beam: pinned at both ends, a point load at the port (3.1)-(3.14), with a Jacobian
// that a finite difference confirms (docs/errata.md). Model frame M: wrist at the origin, x to the
// tip, the shaft in the x-y plane.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

namespace flextip {

/// The load that a flexion Jacobian holds constant while the wrist moves.
enum class BeamLoadLaw : std::uint8_t {
  kPortForce,  ///< F_p, as the thesis assumes (3.2.2)
  kTipForce,   ///< F_t = F_p a / L: a hung mass, soft tissue
};

enum class BeamStatus : std::uint8_t {
  kOk,
  kStraight,  ///< no flexion to be seen: `a` is not observable, the beam is a straight line
  kBadInput,  ///< not finite, or lengths that are not positive
  kNoPort,    ///< no port between wrist and tip fits: the measurements contradict the beam
};

/// A beam fitted to measurements, in R.
struct BeamFit {
  BeamStatus status = BeamStatus::kBadInput;
  double F_p_over_EI = 0.0;  ///< 1/m^2, along -y_M where positive (3.1)
  double a = 0.0;            ///< port's place along x_M (m)
  double length_m = 0.0;
  Eigen::Matrix3d R_RM = Eigen::Matrix3d::Identity();  ///< columns v_x, v_y, v_z (5.29)
  /// Covariance of (F_p/EI, a), from the stated noise; zero where no noise was stated.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();

  bool IsUsable() const { return status == BeamStatus::kOk; }
};

const char* Name(BeamStatus status);

/// Solves the beam through a known wrist and port (m) under a known tip force (N), all in R. The
/// beam feels the part of the force across its chord. Registered as (5.4)-(5.7) would: v_y against
/// the force, so that F_p/EI <= 0. Without a force across, the status is kStraight with `a` known.
BeamFit SolveBeam(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_RP,
                  const Eigen::Vector3d& f_tip, double bending_stiffness_Nm2,
                  double length_m) noexcept;

/// Returns d tip / d wrist in R (3x3) by (5.28), with the in-plane part corrected (docs/errata.md).
/// The port stays where it is, `law` says which load is constant. Out of the plane the shaft swings
/// about the port. Needs 0 < a < length; at F_p/EI = 0 the result is the lever's Jacobian for a
/// port at `a`.
Eigen::Matrix3d BeamJacobian(const BeamFit& fit, BeamLoadLaw law) noexcept;

/// Returns the tip in R (m) by (5.13)-(5.22): along v_x, at the distance that the bent shaft
/// leaves.
Eigen::Vector3d BeamTip(const BeamFit& fit, const Eigen::Vector3d& p_RW) noexcept;

/// Returns the port in R (m) by (3.8).
Eigen::Vector3d BeamPort(const BeamFit& fit, const Eigen::Vector3d& p_RW) noexcept;

/// Returns the tip's load over EI, a vector in R (1/m^2): times EI, the force on the tip (5.15).
Eigen::Vector3d BeamTipLoad(const BeamFit& fit) noexcept;

}  // namespace flextip
