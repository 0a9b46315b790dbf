// Faults between the controller and the wrist: a robot that does not follow, set-points that do not
// arrive, a cycle that is late.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "simulation/faults/fault.h"

namespace flextip::simulation {

class RobotFaults {
 public:
  /// Takes those of `faults` that are of the robot.
  RobotFaults(const std::vector<Fault>& faults, std::uint64_t seed);

  /// Returns the part of its largest speed that the wrist has at `t_s`.
  double SpeedPart(double t_s) const;
  /// Draws whether the set-point of `t_s` is lost.
  bool LosesCommand(double t_s);
  /// Returns how late (s) the cycle that is due at `t_s` runs. A fault makes one cycle late: the
  /// first that is due in its time.
  double LateBy(double t_s);

 private:
  std::vector<Fault> faults_;
  std::mt19937_64 rng_;
};

}  // namespace flextip::simulation
