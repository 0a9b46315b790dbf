// What a hand-eye calibration carries from step to step.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/hand_eye/fit.h"
#include "calibration/hand_eye/hand_eye.h"
#include "calibration/hand_eye/motion.h"
#include "calibration/hand_eye/start.h"
#include "calibration/hand_eye/views.h"
#include "core/matrix_types.h"

namespace flextip {

struct WorkView {
  const HandEyeView* given = nullptr;
  SeenBoard board;
  std::optional<WristAtView> wrist;  ///< at the present time offset
  bool fits_board = false;           ///< the corners are those of the board
  bool used = false;
  std::string reason;  ///< why it is not used
  int candidate = 0;   ///< the board's pose that agrees with the chain
  double chi2 = 0.0;   ///< by which it does

  bool Usable() const { return fits_board && wrist.has_value(); }
  const Pose& SeenPose() const { return board.poses[static_cast<std::size_t>(candidate)].T_CB; }
};

struct HandEyeWork {
  HandEyeMount mount = HandEyeMount::kEyeToHand;
  HandEyeOptions options;
  const WristStream* stream = nullptr;
  std::vector<WorkView> views;
  HandEyeNoise stated, noise;
  bool with_time_offset = false;
  std::string no_time_offset;  ///< why not
  double time_offset_s = 0.0;
  HandEyeState state;
  Eigen::MatrixXd covariance;  ///< of the unknowns

  /// The wrists of all views at the present time offset.
  void MeasureWrists();
  int Used() const;
  /// Of the views used, but for those with `left_out` (by place in `views`).
  HandEyeProblem Problem(const std::vector<std::size_t>& left_out = {}) const;
  /// Of the usable views.
  std::vector<PoseView> PoseViews() const;
  /// Of the chain's pose of the board less the one seen with `information_px2`, the wrist as
  /// measured; `with_frames` also for what is not known of both frames.
  Matrix6d DifferenceCovariance(const WorkView& view, const Matrix6d& information_px2,
                                bool with_frames) const;
  Pose ChainPose(const WorkView& view) const;
};

/// Views whose corners fit no board, or without a wrist pose, are marked; the corners' noise is
/// that of the others about their own best poses.
HandEyeWork BeginHandEye(const HandEyeInput& input, const HandEyeOptions& options);

/// What the fitted work says.
void FillHandEyeResult(const HandEyeWork& work, HandEyeResult& result);

}  // namespace flextip
