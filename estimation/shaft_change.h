// The instrument's present difference from its data: a found model (diagnosis) for estimation.
#pragma once

#include <Eigen/Dense>

#include "kinematics/effect_rod.h"

namespace flextip {

/// Neutral values: the instrument is as its data say. In R and SI units.
struct ShaftChange {
  double stiffness_scale = 1.0;
  double length_delta_m = 0.0;
  Eigen::Vector3d weight_N_m = Eigen::Vector3d::Zero();       ///< beyond the nominal weight
  Eigen::Vector3d wrist_shift_m = Eigen::Vector3d::Zero();    ///< true less measured wrist
  Eigen::Vector3d wrist_misread_m = Eigen::Vector3d::Zero();  ///< of that, what is no play
  Eigen::Vector3d port_shift_m = Eigen::Vector3d::Zero();     ///< from the registered port
  /// Its y_wrist must be the instrument's y axis at this instant where curvature_1_m is not zero.
  RodEffects effects;
  double tip_compliance_m_N = 0.0;  ///< E moves by this times the tip force, the shaft does not
  double wrist_play_m = 0.0;        ///< width of the play; the rest of the shift is its state
};

}  // namespace flextip
