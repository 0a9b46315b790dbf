// The start of a hand-eye calibration: both frames from poses alone, with the choice between the
// two poses under which a flat board is seen nearly alike.
#pragma once

#include <optional>
#include <vector>

#include "calibration/hand_eye/chain.h"
#include "core/matrix_types.h"

namespace flextip {

/// One pose that the board may have, with the covariance of (dw, dp) in C.
struct PoseCandidate {
  Pose T_CB;
  Matrix6d covariance = Matrix6d::Zero();
  double penalty = 0.0;  ///< chi2 by which its corners fit worse than the best candidate's
};

struct PoseView {
  Pose T_RW;
  Matrix6d wrist_covariance = Matrix6d::Zero();  ///< of (dw, dp) in R
  std::vector<PoseCandidate> candidates;         ///< at least one
};

struct HandEyeStart {
  Pose T_FC, T_KB;
  double score = 0.0;       ///< sum over the views of log(1 + chi2 / 6): small is good
  std::vector<int> chosen;  ///< candidate of each view
};

/// Hypotheses from three views each and all choices of their candidates (rotation by aligning the
/// axes of both relative motions, translations linear), and from random rotations for motions that
/// do not fix one; the best are refined and the best of those is taken. A view counts by the
/// candidate that fits, and less the less it fits, so neither flips nor bad views pull. Empty with
/// fewer than three views.
std::optional<HandEyeStart> FindHandEyeStart(HandEyeMount mount, const std::vector<PoseView>& views,
                                             unsigned seed);

/// Only the refinement, from frames that are known roughly.
HandEyeStart RefineHandEyeStart(HandEyeMount mount, const std::vector<PoseView>& views,
                                const Pose& T_FC, const Pose& T_KB);

}  // namespace flextip
