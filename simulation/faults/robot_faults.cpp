#include "simulation/faults/robot_faults.h"

#include <algorithm>

namespace flextip::simulation {

RobotFaults::RobotFaults(const std::vector<Fault>& faults, std::uint64_t seed)
    : rng_(FaultSeed(seed, faults.size())) {
  for (const Fault& fault : faults)
    if (fault.stream == FaultStream::kRobot) faults_.push_back(fault);
}

double RobotFaults::SpeedPart(double t_s) const {
  double part = 1.0;
  for (const Fault& fault : faults_) {
    if (!fault.IsActive(t_s)) continue;
    if (fault.kind == FaultKind::kWristStands) part = 0.0;
    if (fault.kind == FaultKind::kRobotRate) part *= fault.size;
  }
  return part;
}

bool RobotFaults::LosesCommand(double t_s) {
  bool lost = false;
  for (const Fault& fault : faults_) {
    if (fault.kind != FaultKind::kCommandsLost || !fault.IsActive(t_s)) continue;
    lost |= std::uniform_real_distribution<double>()(rng_) < fault.size;
  }
  return lost;
}

double RobotFaults::LateBy(double t_s) {
  double late_s = 0.0;
  for (Fault& fault : faults_) {
    if (fault.kind != FaultKind::kCycleLate || t_s < fault.start_s) continue;
    late_s += fault.size;
    fault.size = 0.0;
  }
  return late_s;
}

}  // namespace flextip::simulation
