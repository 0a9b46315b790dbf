// What a hand-eye calibration's motion can tell, and which further view would tell most.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/hand_eye/fit.h"
#include "calibration/hand_eye/hand_eye.h"

namespace flextip {

/// How the wrist moved, beyond its noise.
struct WristMotion {
  int axes = 0;                                      ///< about how many axes it turned: 0 to 3
  int directions = 0;                                ///< in how many directions it shifted
  double largest_turn_rad = 0.0;                     ///< from the mean
  Eigen::Vector3d axis_R = Eigen::Vector3d::Zero();  ///< of the widest turns
  std::vector<Pose> cleaned;  ///< the wrists without what may be noise: nothing is learnt from it
};
WristMotion MotionOf(const std::vector<Pose>& T_RW, const HandEyeNoise& noise);

/// What stays open: every coordinate of T_FC ("camera.") and T_KB ("board.") that has a part in a
/// direction known to no better than a twentieth of the working distance, or of a radian.
std::vector<Calibration::Unobservable> UnknownCoordinates(const HandEyeProblem& problem,
                                                          const HandEyeState& state,
                                                          const WristMotion& motion);

/// Why the time offset cannot be told; empty where it can.
std::string NoTimeOffsetReason(const HandEyeProblem& problem);

/// Views of the board turned, nearer, farther or aside of the mean one, each by what it leaves of
/// the uncertainty of a point on the board that is carried to F; the best first.
std::vector<HandEyeMotion> HelpfulMotions(const HandEyeProblem& problem, const HandEyeState& state,
                                          const WristMotion& motion);

}  // namespace flextip
