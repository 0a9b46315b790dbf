// A robot arm with inertia: two links in a plane, both driven from the base (a parallelogram, as in
// the Phantom Premium 1.5), and what hangs on its wrist. The arm's own weight is balanced. Nothing
// of kinematics/ is used.
//
// Positions are (z, y): forward and up, the origin at the wrist at home. There the first link lies
// along z and the second hangs from its end. Angles are those of the two motors: the first link
// above z, the second forward of the vertical.
#pragma once

#include <Eigen/Dense>
#include <optional>

namespace flextip::simulation {

/// Of the order of what was identified for the Premium 1.5 (Cavusoglu, Feygin, Tendick 2002), with
/// the thesis's links; motors and counterweights are in the inertias.
struct ArmBody {
  double link1_m = 0.21, link2_m = 0.21;
  double inertia1_kg_m2 = 2.4e-3;  ///< of all that turns with link 1, about its axis
  double inertia2_kg_m2 = 1.0e-3;  ///< of all that turns with link 2
  double wrist_mass_kg = 0.03;     ///< at the wrist
};

/// A rigid uniform shaft that is free to turn at the wrist and slides through a port that turns
/// freely, with Coulomb friction along itself.
struct PortedShaft {
  double length_m = 0.32;
  double mass_kg = 0.0;
  double gravity_m_s2 = 9.81;  ///< along -y; of the shaft only
  Eigen::Vector2d p_port = Eigen::Vector2d::Zero();
  double friction_N = 0.0;  ///< the bound, sliding and sticking
};

/// Motor angles (rad) and rates (rad/s).
struct ArmState {
  Eigen::Vector2d angles = Eigen::Vector2d::Zero();
  Eigen::Vector2d rates = Eigen::Vector2d::Zero();
};

class DynamicArm {
 public:
  explicit DynamicArm(const ArmBody& body, const std::optional<PortedShaft>& shaft = {})
      : body_(body), shaft_(shaft) {}

  Eigen::Vector2d Wrist(const Eigen::Vector2d& angles) const;
  /// d wrist / d angles (m/rad).
  Eigen::Matrix2d Jacobian(const Eigen::Vector2d& angles) const;
  /// kg m^2.
  Eigen::Matrix2d MassMatrix(const Eigen::Vector2d& angles) const;
  /// What the motors carry at rest, without friction (Nm).
  Eigen::Vector2d GravityTorque(const Eigen::Vector2d& angles) const;
  /// From the wrist to the port (m), and its derivative by the angles: what slides. Need a shaft.
  double Sliding(const Eigen::Vector2d& angles) const;
  Eigen::RowVector2d SlidingRate(const Eigen::Vector2d& angles) const;
  double KineticEnergy(const ArmState& state) const;  ///< J

  /// One step of semi-implicit Euler under motor torques and a force on the wrist. Friction is the
  /// impulse that stops the sliding within the step, or its bound where that is less: what sticks,
  /// sticks exactly (Moreau's time stepping). `dt_s` is to be short against what the torques react
  /// to: 1e-4 s or less.
  void Step(ArmState& state, const Eigen::Vector2d& torque_Nm, const Eigen::Vector2d& f_wrist_N,
            double dt_s) const;

 private:
  Eigen::Vector2d VelocityForces(const ArmState& state) const;

  ArmBody body_;
  std::optional<PortedShaft> shaft_;
};

/// The joints' controller: torque = kp e + ki int e dt - kd rate.
struct PidGains {
  double kp_Nm_rad = 0.0, ki_Nm_rad_s = 0.0, kd_Nms_rad = 0.0;
};

class JointPid {
 public:
  /// `torque_Nm`: what the integral has learned before, as at rest under a load.
  JointPid(const PidGains& gains, const Eigen::Vector2d& torque_Nm)
      : gains_(gains), integral_Nm_(torque_Nm) {}

  /// Once a period of `dt_s`, with the angles' errors and rates.
  Eigen::Vector2d Torque(const Eigen::Vector2d& error, const Eigen::Vector2d& rates, double dt_s) {
    integral_Nm_ += gains_.ki_Nm_rad_s * dt_s * error;
    return gains_.kp_Nm_rad * error + integral_Nm_ - gains_.kd_Nms_rad * rates;
  }

 private:
  PidGains gains_;
  Eigen::Vector2d integral_Nm_;
};

}  // namespace flextip::simulation
