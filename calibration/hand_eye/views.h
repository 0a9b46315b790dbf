// What one view says by itself: the board's pose by its corners, and the wrist's at that time.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "calibration/hand_eye/chain.h"
#include "core/matrix_types.h"

namespace flextip {

/// A minimum of the reprojection error of a board seen by itself.
struct BoardPose {
  Pose T_CB;
  Matrix6d information_px2 = Matrix6d::Zero();  ///< of (dw, dp) in C, for corners good to 1 px
  double squared_px2 = 0.0;
};

struct SeenBoard {
  std::vector<Correspondence> points;  ///< corners that fit, B in the place of E
  std::vector<BoardPose> poses;        ///< distinct minima, the best first; at most two
  int dropped = 0;                     ///< corners that did not fit
  std::string reason;                  ///< why there is no pose

  int Dof() const { return 2 * static_cast<int>(points.size()) - 6; }
  double RmsPx() const;
};

/// Both planar poses of a flat board, or those of every four corners of a collar, refined on all
/// corners. Corners far off what the others say are left out.
SeenBoard FitSeenBoard(const CameraModel& camera, const BoardSighting& sighting);

/// The same poses under another camera.
void RefitSeenBoard(const CameraModel& camera, SeenBoard& seen);

/// The wrist around one time.
struct WristAtView {
  Pose T_RW;
  /// d(T_RW)/dt as (dw, dp) in R (rad/s, m/s), by the difference of two samples beyond those that
  /// T_RW comes from, so that their noise has nothing to do with T_RW's; and its variance over
  /// that of a sample (1/s2). Absent where the samples are too far apart.
  std::optional<Vector6d> velocity;
  double velocity_noise_1_s2 = 0.0;
  Vector6d step = Vector6d::Zero();  ///< between those two samples, and how far from their middle
  Vector6d bend = Vector6d::Zero();  ///< T_RW is: small where interpolation can be trusted
  double noise_share = 1.0;  ///< variance of T_RW over that of a sample: interpolation averages
};

/// Empty outside the stream, in its gaps and where the orientation is not measured.
std::optional<WristAtView> WristAround(const WristStream& stream, TimeNs t_ns);

}  // namespace flextip
