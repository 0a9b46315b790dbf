#include "simulation/plant/setup.h"

#include <cmath>

namespace flextip::simulation {
namespace {

constexpr double kContactOnset_m = 1e-3;
constexpr double kPlayForce_N = 0.02;  // the rim and the shaft are not ideally hard

/// A breath: a sine, sharper at the top where there is a second harmonic.
double Breath(const PortBreathing& motion, double t_s) {
  const double phase = 2.0 * M_PI * motion.frequency_hz * t_s + motion.phase_rad;
  return std::sin(phase) - motion.second_harmonic * std::cos(2.0 * phase);
}

bool AreFinite(const PlantEffects& e) {
  const double scalars =
      e.stiffness_scale + e.length_delta_m + e.mass_per_length_kg_m + e.port_motion.frequency_hz +
      e.port_motion.phase_rad + e.port_motion.second_harmonic + e.port_compliance_m_N +
      e.port_play_m + e.port_friction.coefficient + e.port_friction.grip_from_m +
      e.port_friction.grip_to_m + e.port_friction.grip_force_N + e.port_stiffness_Nm_rad +
      e.wrist_compliance_m_N + e.tip_compliance_m_N + e.backlash_m + e.taper +
      e.wrist_reading.scale + e.wrist_reading.eccentricity_m + e.wrist_reading.wavelength_m +
      e.wrist_reading.phase_rad + e.second_contact.s_from_tip_m + e.second_contact.stiffness_N_m +
      e.shaft_tissue.stiffness_N_m2 + e.shaft_tissue.time_constant_s;
  return std::isfinite(scalars) && e.curvature_1_m.allFinite() && e.port_offset_m.allFinite() &&
         e.port_motion.amplitude_m.allFinite() && e.port_rest_axis.allFinite() &&
         e.shaft_load_N_m.allFinite() && e.second_contact.p_surface.allFinite() &&
         e.second_contact.normal.allFinite();
}

bool AnyNegative(const PlantEffects& e) {
  return e.port_compliance_m_N < 0 || e.port_play_m < 0 || e.port_friction.coefficient < 0 ||
         e.port_friction.grip_force_N < 0 || e.port_stiffness_Nm_rad < 0 ||
         e.wrist_compliance_m_N < 0 || e.tip_compliance_m_N < 0 || e.backlash_m < 0 ||
         e.second_contact.stiffness_N_m < 0 || e.shaft_tissue.stiffness_N_m2 < 0;
}

}  // namespace

PlantUnits::PlantUnits(const PlantSetup& setup)
    : length_m(setup.instrument.length_m + setup.effects.length_delta_m),
      stiffness_Nm2(setup.instrument.bending_stiffness_Nm2 * setup.effects.stiffness_scale),
      force_N(stiffness_Nm2 / (length_m * length_m)),
      moment_Nm(stiffness_Nm2 / length_m) {}

Eigen::Vector3d PortAt(const PlantSetup& setup, double t_s) {
  const PlantEffects& effects = setup.effects;
  return setup.p_RP + effects.port_offset_m +
         Breath(effects.port_motion, t_s) * effects.port_motion.amplitude_m;
}

const char* WhatIsWrong(const PlantSetup& setup) {
  const PlantEffects& effects = setup.effects;
  const PlantUnits units(setup);
  if (!setup.p_RP.allFinite() || !setup.weight_N_m.allFinite() || !setup.gravity_m_s2.allFinite() ||
      !setup.load.constant_N.allFinite()) {
    return "wrist, port, weight or force is not finite";
  }
  if (!AreFinite(effects)) return "an effect's parameter is not finite";
  if (!(units.length_m > 0) || !(units.stiffness_Nm2 > 0) ||
      !std::isfinite(units.length_m * units.stiffness_Nm2)) {
    return "length or bending stiffness is not positive";
  }
  const WristReading& reading = effects.wrist_reading;
  if (!(reading.scale > 0) || !(reading.wavelength_m > 0)) {
    return "the scale of the wrist's reading or its pulley's wavelength is not positive";
  }
  if (!(2.0 * M_PI * std::abs(reading.eccentricity_m) < reading.wavelength_m)) {
    return "the pulley's eccentricity is not small against its wavelength";
  }
  if (!(setup.torsion > 0)) return "the torsional stiffness is not positive";
  if (AnyNegative(effects)) return "a compliance, stiffness, play or friction is negative";
  if (!(std::abs(effects.taper) < 1)) return "a taper of 1 or more leaves no stiffness at one end";
  if (effects.port_rest_axis.norm() == 0 || effects.second_contact.normal.norm() == 0) {
    return "the port's rest axis or the second contact's normal has no direction";
  }
  const SecondContact& contact = effects.second_contact;
  if (contact.stiffness_N_m > 0 &&
      !(contact.s_from_tip_m >= 0 && contact.s_from_tip_m < units.length_m)) {
    return "the second contact is not on the shaft";
  }
  if (effects.shaft_tissue.stiffness_N_m2 > 0 && !(effects.shaft_tissue.time_constant_s > 0)) {
    return "the shaft tissue's time constant is not positive";
  }
  return "";
}

ChainProblem MakeChain(const PlantSetup& setup, const PlantOptions& options,
                       const Eigen::Vector3d& p_RW, double t_s, double fraction) {
  const PlantEffects& effects = setup.effects;
  const PlantUnits units(setup);
  const double length = units.length_m, force = units.force_N;
  ChainProblem problem;
  problem.n1 = options.links_before_port;
  problem.n2 = options.links_behind_port;
  problem.p_port = (PortAt(setup, t_s) - p_RW) / length;
  const Eigen::Vector3d weight =
      setup.weight_N_m + effects.mass_per_length_kg_m * setup.gravity_m_s2;
  problem.q = fraction * weight * length / force;
  problem.q_inside = fraction * effects.shaft_load_N_m * length / force;
  problem.load = [&setup, p_RW, fraction, length, force](const Eigen::Vector3d& x_tip) {
    const LinearTipForce load = setup.load.At(p_RW + length * x_tip);
    return ChainForce{fraction / force * load.f_N, fraction * length / force * load.df_dp_N_m};
  };
  problem.taper = effects.taper;
  problem.curvature = fraction * length * effects.curvature_1_m;
  problem.roll_rad = setup.roll_rad;
  problem.torsion = setup.torsion;
  problem.wrist_compliance = fraction * effects.wrist_compliance_m_N * force / length;
  problem.tip_compliance = fraction * effects.tip_compliance_m_N * force / length;
  problem.port = {fraction * effects.port_compliance_m_N * force / length,
                  fraction * effects.port_play_m / length, kPlayForce_N / force,
                  fraction * effects.port_stiffness_Nm_rad / units.moment_Nm,
                  effects.port_rest_axis.normalized()};
  const SecondContact& contact = effects.second_contact;
  if (contact.stiffness_N_m > 0) {
    problem.contact = {1.0 - contact.s_from_tip_m / length, (contact.p_surface - p_RW) / length,
                       contact.normal.normalized(),
                       fraction * contact.stiffness_N_m * length / force, kContactOnset_m / length};
  }
  return problem;
}

}  // namespace flextip::simulation
