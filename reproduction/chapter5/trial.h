// One trial of the user study: an operator, a fixture, a controller, a wrist under PD control and
// silicone, for a minute. Private to reproduction.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "control/controller.h"
#include "simulation/arm/operator.h"

namespace flextip::reproduction {

enum class TipSense : std::uint8_t { kEm, kVision };

/// What is varied. The defaults are the thesis's 5.2.6.
struct TrialSetup {
  ControllerKind kind = ControllerKind::kFlexTrack;
  TipSense sense = TipSense::kEm;
  double update_rate_hz = 144.0;  ///< rate of the tip's sensor and the controller
  /// Of EM, per axis.
  double em_position_noise_m = 1.3e-4, em_orientation_noise_rad = 5.6e-4;
  double vision_latency_s = 0.0;
  bool occlusions = false;
  /// (5.4), (5.13): also the calculating controller takes the chord's direction from the measured
  /// tip. False: from the orientations alone.
  bool chord_measured = true;
  bool tissue_response = true;  ///< estimated and used, by the rod
  /// Lasting differences between the rod's tip and the sensor's are settled in the sensor's favour.
  bool level_tip = false;
  double margin_sd = 0.0;       ///< the wall is taken this many of the estimate's deviations early
  double silicone_scale = 1.0;  ///< factor of all the silicone's forces
  double arm_stiffness_N_m = 1000.0;  ///< stiffness of the PD control
  /// What the instrument is beyond its data: stiffness (relative), length, port, all at once.
  double stiffness_error = 0.0, length_error_m = 0.0, port_error_m = 0.0;
  double em_offset_m = 0.0;   ///< EM positions are off by this along x
  double em_latency_s = 0.0;  ///< EM is late by this, the arm's encoders are not
  bool hold_still = false;    ///< no operator: the tip is held in the middle, above the surface
  double seconds = 60.0;
  int links = 50;  ///< links of the plant on each side of the port
  std::uint64_t operator_seed = 1, noise_seed = 1;
};

/// Where things are, everything in R: x from the robot to the dish.
struct TrialPlaces {
  Eigen::Vector3d p_RP{0.460, 0.0, 0.0};
  double surface_x_m = 0.740;
  double wall_depth_m = 0.006;
  double outline_radius_m = 0.020;
  double WallX() const { return surface_x_m + wall_depth_m; }
};

struct Trial {
  double rate_hz = 0.0;                   ///< rate of `tips` and `recorded`
  std::vector<Eigen::Vector3d> tips;      ///< true
  std::vector<Eigen::Vector3d> recorded;  ///< by the EM sensor, as in the thesis
  double max_flexion_m = 0.0;             ///< tip from the straight line through the port
  double rms_flexion_m = 0.0;
  double max_side_force_N = 0.0, rms_side_force_N = 0.0;
  double max_push_N = 0.0;            ///< along the axis, by the silicone
  double cut_part = 0.0;              ///< part of the outline's inside that is cut
  double rms_error_m = 0.0;           ///< error of the true tip against the desired tip, per axis
  double rms_recorded_error_m = 0.0;  ///< the same as recorded
  double straight_part = 0.0;         ///< part of the updates that fell back on the straight shaft
  double no_tip_part = 0.0;           ///< part of the updates without a tip
  bool lost = false;                  ///< the simulated shaft found no equilibrium: ended early
};

Trial RunTrial(const TrialSetup& setup, const TrialPlaces& places = {});

}  // namespace flextip::reproduction
