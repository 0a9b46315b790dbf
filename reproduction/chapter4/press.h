// The dynamic trials of 4.3.2: an arm under a joint PID presses the flexed shaft's tip into
// silicone and draws it back. Private to reproduction. The plane is x-y, y up.
#pragma once

#include <cstdint>
#include <vector>

#include "reproduction/chapter4/controllers.h"
#include "reproduction/chapter4/steps.h"
#include "simulation/arm/dynamic_arm.h"

namespace flextip::reproduction {

struct PressSetup {
  Ch4Kind kind = Ch4Kind::kStraight;
  bool strain = false;                  ///< the model from moments instead of directions
  double tissue_N_m = 79.0;             ///< stiffness of the block, normal to the surface
  double tissue_tangential_N_m = 10.0;  ///< along the surface, which is dusted with talcum
  double depth_m = 0.015;
  double port_friction = 0.0;  ///< coefficient, of the block that is the port
  /// A trial takes about 2 s, and the proportional part alone does not reach the goal.
  simulation::PidGains pid{10.0, 10.0, 0.5};
  bool load_on_arm = true;  ///< false: a transmission so high that the motors do not feel the shaft
  double inertia_scale = 1.0;
  bool expects_tissue = true;  ///< the rod's model may find the block's stiffness
  double inner_hz = 2000.0, outer_hz = 120.0;
  double position_noise_m = 0.00013, angle_noise_rad = 0.00056;  ///< standard deviations (3.4.2)
  double moment_noise_Nm = 0.0008;
  double reached_m = 0.0005;  ///< the tip as known, from its goal
  double longest_s = 8.0;     ///< time limit of each way
  std::uint64_t seed = 0;
};

struct PressRun {
  std::vector<Eigen::Vector3d> p_RE;  ///< true, at each update
  std::vector<double> t_s;
  Eigen::Vector3d p_start = Eigen::Vector3d::Zero();
  double max_m = 0.0, rms_m = 0.0;          ///< from the vertical through the start
  double max_down_m = 0.0, max_up_m = 0.0;  ///< on either way
  double overshoot_m = 0.0;                 ///< along the vertical, past either goal
  double down_s = 0.0, up_s = 0.0;
  double peak_force_N = 0.0;
  double peak_flexion_m = 0.0;  ///< distance of the tip from a straight shaft's tip
  int straight_instead = 0;     ///< updates
  bool finished = false;        ///< both goals were reached in time
  bool lost = false;            ///< the shaft lost its equilibrium
};

PressRun RunPress(const PressSetup& setup);

}  // namespace flextip::reproduction
