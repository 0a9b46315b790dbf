// A robot that is not there: the plant and its sensors behind a robot's face. No sockets, no
// threads, no wall clock: time is what Advance is given.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/robot/crtk.h"
#include "core/tip_observation.h"
#include "recording/recording.h"
#include "recording/truth.h"
#include "simulation/plant/curve_history.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/sensors.h"
#include "simulation/virtual_robot/crtk_machine.h"
#include "simulation/virtual_robot/wrist_servo.h"

namespace flextip::simulation {

struct VirtualRobotSetup {
  Recording base;  ///< what the kept recording begins with: instrument, port, camera; no samples
  PlantSetup plant;
  PlantOptions plant_options;
  Eigen::Vector3d p_RW_start = Eigen::Vector3d::Zero();
  WristServoSetup servo;
  SensorSetup sensors;
  SensorEffects sensor_effects;
  double picture_rate_hz = 0.0;  ///< 0: no pictures are due
  double homing_s = 0.5;
  std::uint64_t seed = 1;
  bool keep = true;  ///< keep samples, set-points and truth; else memory does not grow
};

struct EmReading {
  int sensor = 0;  ///< 0: on the shaft, 1: on the port
  EmSample sample;
};
struct StrainReading {
  Eigen::Vector4d moments_Nm = Eigen::Vector4d::Zero();
};
struct ForceReading {
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
};
/// The camera is to take a picture of the shaft.
struct PictureDue {
  ShaftCurve curve;
  int number = 0;
};

struct VirtualSample {
  TimeNs t_ns = 0;
  std::variant<WristSample, EmReading, StrainReading, ForceReading, TipObservation, PictureDue,
               CrtkOperatingState>
      value;
};

/// Time runs from kSimulationStart_ns. Each sensor and the camera have their own clock. The state
/// comes at each change and once a second.
class VirtualRobot {
 public:
  /// Throws InputError where the shaft has no equilibrium at the start.
  explicit VirtualRobot(const VirtualRobotSetup& setup);

  /// Moves time on to `t_ns` and returns all samples that fell due since the last call, by time.
  /// The wrist goes to its set-points as its servo does. Where the shaft loses its
  /// equilibrium, the robot stays at the last one, in FAULT.
  std::vector<VirtualSample> Advance(TimeNs t_ns);

  /// Takes a command now. Returns false where it is refused. The robot stays where it is: old
  /// set-points are forgotten.
  bool Command(CrtkCommand command);
  /// Takes a set-point of the wrist (m, in R) now. Returns false where it is not followed: the
  /// robot is not enabled, not homed or busy, or the numbers are none. Its orientation is not free.
  bool MoveTo(const Eigen::Vector3d& p_RW);

  TimeNs Now() const { return now_ns_; }
  TimeNs NextDue() const;
  const CrtkOperatingState& State() const { return machine_.State(); }
  /// Returns why the robot is or was last in FAULT, empty where it never was.
  const std::string& FaultReason() const { return fault_reason_; }
  /// Returns the shape at the last time something was due.
  const PlantShape& Shape() const { return shape_; }

  /// What was kept. Set-points that were followed are command0.
  const Recording& Kept() const { return kept_; }
  const Series<TruthSample>& Truth() const { return truth_; }

 private:
  void MoveWrist(TimeNs t_ns);
  void Solve(TimeNs t_ns);
  void Sense(TimeNs t_ns, std::vector<VirtualSample>& samples);
  void TakeNew(TimeNs t_ns, std::vector<VirtualSample>& samples);
  void SayState(TimeNs t_ns);
  TimeNs PictureTime() const;
  TimeNs StateTime() const;

  VirtualRobotSetup setup_;
  Plant plant_;
  Sensors sensors_;
  CrtkMachine machine_;
  PlantShape shape_;
  WristServo servo_;
  Eigen::Vector3d p_RW_solved_;
  CurveHistory curves_;
  TimeNs now_ns_ = kSimulationStart_ns;
  int pictures_ = 0, state_ticks_ = 0;
  std::string fault_reason_;
  std::vector<VirtualSample> waiting_;  // states that commands led to
  Recording kept_;
  Series<TruthSample> truth_;
};

}  // namespace flextip::simulation
