// The nominal part of a hidden recording: instrument, port, wrist motion, load, sensors.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/instrument.h"
#include "recording/recording.h"
#include "simulation/plant/effects.h"
#include "simulation/sensors/sensors.h"
#include "simulation/tissue/tip_load.h"
#include "testdata/hidden/motion.h"

namespace flextip::hidden {

enum class LoadKind : std::uint8_t {
  kNone,
  kHungMass,  ///< a constant force along gravity
  kTissue,    ///< soft tissue that the tip dips into for most of the motion
  kVarying,   ///< a slow, smooth random force
};
inline constexpr int kLoadKinds = 4;
const char* Name(LoadKind kind);

/// The load on the tip over time, in R.
struct LoadCourse {
  LoadKind kind = LoadKind::kNone;
  Eigen::Vector3d mean_N = Eigen::Vector3d::Zero();
  std::optional<simulation::Tissue> tissue;
  /// Columns of one sine each: amplitude (N), and frequency (Hz) and phase (rad) beside it.
  std::vector<Eigen::Vector3d> amplitudes_N;
  std::vector<double> frequencies_hz, phases_rad;

  simulation::TipLoad At(double t_s) const;
};

struct SceneDraw {
  MotionFamily family = MotionFamily::kTuning;
  std::optional<MotionKind> motion;  ///< drawn from the family where empty
  std::optional<LoadKind> load;      ///< drawn where empty: rarely none
  double duration_s = 20.0;
};

struct HiddenScene {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
  MotionSetup motion_setup;
  std::uint64_t motion_seed = 0;
  LoadCourse load;
  double roll_rad = 0.0, roll_swing_rad = 0.0, roll_frequency_hz = 0.0, roll_phase_rad = 0.0;
  CameraCalibration camera;
  simulation::SensorSetup sensors;
  double duration_s = 20.0;

  WristCourse Motion() const { return {motion_setup, motion_seed, duration_s}; }
  double RollAt(double t_s) const;
  /// EI / L^2: the force that bends clearly.
  double UnitForce() const {
    return instrument.bending_stiffness_Nm2 / (instrument.length_m * instrument.length_m);
  }
};

/// Shafts of 0.35 to 0.6 m of steel or nitinol, wire or tube, EI 0.1 to 1.5 N m^2 and at most 4 N
/// L^2; forces of up to 0.6 to 1.5 EI / L^2, at most 2 N; the camera 0.15 to 0.3 m from the tip's
/// mean place where it then has the whole motion in view, else farther.
HiddenScene DrawScene(const SceneDraw& draw, std::mt19937_64& rng);

/// The same instrument, port, camera and sensors; motion about nearly the same axis, load and roll
/// are drawn anew.
HiddenScene WithOtherMotion(const HiddenScene& scene, const SceneDraw& draw, std::mt19937_64& rng);

/// Sets the forms outside the catalogue that act on the shaft, in sizes that matter for this scene:
/// port_grip (the middle of the stretch that slides through the port, up to twice EI / L^2), taper,
/// shaft_tissue, second_contact (touched for part of the motion). Others are ignored.
void AddShaftForm(const std::string& form, const HiddenScene& scene, std::mt19937_64& rng,
                  simulation::PlantEffects& effects);

}  // namespace flextip::hidden
