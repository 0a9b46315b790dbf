// Recordings of an arm that is not there, with what is wrong with it.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "recording/recording.h"
#include "simulation/joints/arm_plant.h"

namespace flextip::simulation {

/// What the arm's file does not say. Empty vectors: nothing.
struct ArmFaults {
  Eigen::VectorXd encoder_offset;  ///< true motor less encoder
  Eigen::VectorXd encoder_scale;   ///< true motor over encoder, less one
  Eigen::MatrixXd routing;         ///< ArmPlantSettings::routing
  Eigen::VectorXd play;
  Eigen::VectorXd a_change_m;  ///< of each link
  std::vector<PointMass> payload;
  Eigen::VectorXd motor_coulomb, motor_viscous;
  Eigen::VectorXd cable_stiffness, servo_stiffness, servo_damping;
  double command_delay_s = 0.0;
  bool servo_holds_gravity = true;
  Eigen::Vector3d marker_m = Eigen::Vector3d::Zero();   ///< off its place on the last link
  Eigen::Vector3d tracker_m = Eigen::Vector3d::Zero();  ///< off its place in R
};

struct ArmSensors {
  bool command = true, encoders = true, seen = false, pose = false, torque = false;
};

struct ArmMotion {
  double seconds = 20.0, rate_hz = 50.0;
  double fastest_hz = 0.4;
  double size_rad = 0.3, size_m = 0.03;
  std::uint64_t seed = 1;
};

/// Returns the drive that a joint has where no fault says otherwise: so stiff that nothing of it
/// shows. As stiff for a slide, in its units.
JointDrive StiffDrive(bool turns);

/// Returns 1 over a compliance, `own` (> 0) at most.
double StiffnessOf(double compliance, double own);

/// Three joints with masses stated in their file: shoulder, elbow, slide.
Arm SmallArm();

/// The plant of `arm` with its faults, but for what its encoders read. Where there is play there is
/// no gravity, and the links have friction: else they would hang on one side of it.
ArmPlantSettings PlantOf(const Arm& arm, const ArmFaults& faults);

/// Moves the plant of `arm` with its faults along a smooth motion, and records it by its file.
Recording RecordArm(const Arm& arm, const ArmFaults& faults, const ArmSensors& sensors,
                    const ArmMotion& motion);

}  // namespace flextip::simulation
