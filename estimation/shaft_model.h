// The instrument as estimation believes it to be now, for control.
#pragma once

#include <Eigen/Dense>

#include "core/instrument.h"
#include "kinematics/beam.h"
#include "kinematics/effect_rod.h"

namespace flextip {

/// Fixed data and the last estimate. Everything in R; fixed size.
struct ShaftModel {
  Instrument instrument;  ///< with the length and stiffness of a found model
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();                  ///< port
  Eigen::Vector3d weight_N_m = Eigen::Vector3d::Zero();            ///< self-weight per length
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();               ///< force on the tip (rod)
  Eigen::Matrix3d tissue_stiffness_N_m = Eigen::Matrix3d::Zero();  ///< df_tip/dp_tip (rod)
  bool force_known = false;  ///< f_tip_N was estimated or measured
  // Of a found model (ShaftChange); for the rod.
  RodEffects effects;
  double tip_compliance_m_N = 0.0;
  Eigen::Vector3d wrist_shift_m = Eigen::Vector3d::Zero();    ///< true less measured wrist
  Eigen::Vector3d wrist_misread_m = Eigen::Vector3d::Zero();  ///< of that, what is no play
  double wrist_play_m = 0.0;
  BeamFit beam;  ///< the thesis's parameters (flexion)
};

/// Returns whether every number of `model` is one that a shaft can have: finite, and within bounds
/// wide of any instrument's (shaft_model.cpp). The beam counts where it is usable.
bool IsPlausible(const ShaftModel& model);

}  // namespace flextip
