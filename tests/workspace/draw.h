// Random states and errors of the instruments under test.
#pragma once

#include <random>

#include "workspace/belief.h"
#include "workspace/true_shaft.h"

namespace flextip {

/// Joint angles within the limits.
inline Eigen::Vector2d DrawJoints(const PlanarArm& arm, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> first(arm.limits.joint1_min, arm.limits.joint1_max);
  std::uniform_real_distribution<double> second(arm.limits.joint2_min, arm.limits.joint2_max);
  for (;;) {
    const double second_angle = second(rng), first_angle = first(rng);
    const Eigen::Vector2d theta(first_angle, second_angle);
    if (arm.WithinLimits(theta)) return theta;
  }
}
inline Eigen::Vector3d DrawJoints(const PhantomArm& arm, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> base(-0.8, 0.8);
  const Eigen::Vector2d links = DrawJoints(arm.links, rng);
  return {base(rng), links[0], links[1]};
}

/// A state whose port is between 0.1 and 0.9 of the shaft's length from the wrist.
template <int N>
TrueState<N> DrawState(const PortInstrument<N>& instrument, std::mt19937_64& rng) {
  TrueShaft<N> shaft(instrument, std::nullopt);
  for (;;) {
    const VectorN<N> theta = DrawJoints(instrument.arm, rng);
    const double distance = (instrument.p_port - instrument.arm.Wrist(theta)).norm();
    if (distance < 0.1 * instrument.shaft_m || distance > 0.9 * instrument.shaft_m) continue;
    return *shaft.AtJoints(theta);
  }
}

/// Errors of a few mm and hundredths of a radian.
template <int N>
BeliefError<N> DrawError(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  BeliefError<N> error;
  for (double& x : error.port_m) x = 0.005 * normal(rng);
  for (double& x : error.links_m) x = 0.003 * normal(rng);
  for (double& x : error.joints_rad) x = 0.02 * normal(rng);
  error.shaft_m = 0.005 * normal(rng);
  return error;
}

}  // namespace flextip
