// A real instrument's differences from a nominal instrument: the plant's side, by its own physics
// (the names and parameters are those of docs/effects.md). Neutral values: no effect.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

namespace flextip::simulation {

/// Breathing: the port moves by amplitude x w(2 pi f t + phase), where w is a sine with
/// overtones: sharper at the top, as breath is.
struct PortBreathing {
  Eigen::Vector3d amplitude_m = Eigen::Vector3d::Zero();
  double frequency_hz = 0.0, phase_rad = 0.0;
  double second_harmonic = 0.0;  ///< relative amplitude
};

/// Coulomb friction along the shaft where it slides through the port, with stick; of the whole
/// shaft, or, as a port that grips, of one stretch of it only.
struct PortFriction {
  double coefficient = 0.0;
  double grip_from_m = 0.0, grip_to_m = 0.0;  ///< stretch from the wrist; equal: the whole shaft
  double grip_force_N = 0.0;  ///< friction force of the stretch, whatever the lateral force is
};

/// A second thing the shaft or tip leans on: a frictionless half space that pushes the shaft at
/// `s_from_tip_m` along its outward normal, with a soft onset.
struct SecondContact {
  double s_from_tip_m = 0.0;
  Eigen::Vector3d p_surface = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();
  double stiffness_N_m = 0.0;
};

/// Tissue along the part beyond the port that drags: a force per length toward where the shaft has
/// been, relaxing with `time_constant_s` (a Maxwell element for each part of the shaft).
struct ShaftTissue {
  double stiffness_N_m2 = 0.0;
  double time_constant_s = 1.0;
};

/// How the encoders misread the wrist (wrist_reading.h).
struct WristReading {
  double scale = 1.0;  ///< of a displacement from `about_m`, as measured over the true one
  std::optional<Eigen::Vector3d> about_m;  ///< empty: the first place that the plant is at
  /// A pulley off its centre: along the shaft, a sine of the distance from wrist to port.
  double eccentricity_m = 0.0, wavelength_m = 0.02, phase_rad = 0.0;
};

struct PlantEffects {
  double stiffness_scale = 1.0;
  double length_delta_m = 0.0;
  double mass_per_length_kg_m = 0.0;                        ///< beyond the nominal one
  Eigen::Vector2d curvature_1_m = Eigen::Vector2d::Zero();  ///< about the instrument's y and z axes
  Eigen::Vector3d port_offset_m = Eigen::Vector3d::Zero();
  PortBreathing port_motion;
  double port_compliance_m_N = 0.0;
  double port_play_m = 0.0;  ///< radius of the hole's play: the shaft lies against its rim
  PortFriction port_friction;
  double port_stiffness_Nm_rad = 0.0;
  Eigen::Vector3d port_rest_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d shaft_load_N_m = Eigen::Vector3d::Zero();  ///< on the part beyond the port, in R
  double wrist_compliance_m_N = 0.0;
  double tip_compliance_m_N = 0.0;  ///< the tip E moves by this times its force; the shaft does not
  double backlash_m = 0.0;          ///< play per axis between measured and true wrist
  WristReading wrist_reading;

  // Not in the catalogue.
  double taper = 0.0;  ///< stiffness times 1 + taper (1 - 2 s / L)
  SecondContact second_contact;
  ShaftTissue shaft_tissue;
};

}  // namespace flextip::simulation
