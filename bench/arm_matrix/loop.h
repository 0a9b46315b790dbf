// What a diagnosis is worth on the arm that it was made of: moved as desired, and by a
// feed-forward.
#pragma once

#include <vector>

#include "arms/diagnose/diagnose.h"
#include "bench/arm_matrix/draw.h"

namespace flextip::bench {

/// Root mean square of true joints less desired ones (rad, m), and of the tip.
struct ArmLoop {
  std::vector<double> before, after;
  double tip_before_m = 0.0, tip_after_m = 0.0;
};

/// Moves the hidden arm itself along another motion.
ArmLoop RunArmLoop(const HiddenArm& hidden, const arms::ArmModel& model);

}  // namespace flextip::bench
