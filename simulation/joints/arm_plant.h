// Motors that pull links by cables: servo, inertia, friction, stretch and play of every joint.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "simulation/joints/chain_of_links.h"

namespace flextip::simulation {

/// One joint's drive, in the joint's units (rad and Nm, or m and N).
struct JointDrive {
  double motor_inertia = 0.02;
  double servo_stiffness = 400.0, servo_damping = 8.0;  ///< effort by error, against speed
  double cable_stiffness = 4000.0, cable_damping = 4.0;
  double play = 0.0;                                ///< whole width
  double motor_coulomb = 0.0, motor_viscous = 0.0;  ///< against the motor
  double link_coulomb = 0.0;                        ///< against the link
};

struct ArmPlantSettings {
  Arm arm;  ///< the true one
  std::vector<JointDrive> drives;
  std::vector<PointMass> masses;
  Eigen::MatrixXd routing;  ///< how far a motor's cable pulls each joint; identity: its own alone
  double command_delay_s = 0.0;
  double links_step_s = 1e-3;       ///< the links' matrices are made anew
  bool servo_holds_gravity = true;  ///< the servo is told what gravity asks for
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
};

/// What sensors can see of the plant at one time.
struct ArmPlantState {
  double t_s = 0.0;
  Eigen::VectorXd motor, motor_speed, link, link_speed, effort;
};

/// The command that was given at a time.
using CommandAtTime = std::function<Eigen::VectorXd(double t_s)>;

/// One arm that moves on, for a loop that looks at it in between.
class ArmPlant {
 public:
  /// In balance at `command`, at rest.
  ArmPlant(const ArmPlantSettings& settings, const Eigen::VectorXd& command, double t_s = 0.0);
  /// Moves on; asks for commands of times up to then, less the delay. Throws WorkError where steps
  /// are too long for the cables.
  void AdvanceTo(double t_s, const CommandAtTime& command_at);
  const ArmPlantState& State() const { return state_; }

 private:
  void StepOfLinks(double dt, const CommandAtTime& command_at);

  ArmPlantSettings settings_;
  ChainOfLinks chain_;
  ArmPlantState state_;
};

/// Runs the plant along commands (rows at `t_s`, evenly), starting in balance at the first, and
/// returns its state at each row. Throws WorkError where steps are too long for the cables.
std::vector<ArmPlantState> RunArm(const ArmPlantSettings& settings, const Eigen::VectorXd& t_s,
                                  const Eigen::MatrixXd& commands);

}  // namespace flextip::simulation
