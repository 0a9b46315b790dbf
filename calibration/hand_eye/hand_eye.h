// Hand-eye calibration: where the camera stands in R and the board on the wrist, or the camera on
// the wrist and the board in R, from views of the board and the robot's wrist poses.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/boards/board.h"
#include "core/camera.h"
#include "core/matrix_types.h"
#include "core/pose.h"
#include "core/time_series.h"
#include "recording/calibrations/file.h"
#include "recording/recording.h"

namespace flextip {

/// Who moves. The two frames that are sought have the same role in both: the camera stands still in
/// frame F, the board in frame K.
enum class HandEyeMount {
  kEyeToHand,  ///< F = R, K = W: the board is on the wrist
  kEyeInHand   ///< F = W, K = R: the camera is on the wrist
};

/// One picture in which the board was looked for. `sighting` may be any known points, also of a
/// collar (then four corners a tag, in the order of the tags), in the frame B of the board.
struct HandEyeView {
  std::string name;
  TimeNs t_ns = 0;
  BoardSighting sighting;
};

struct HandEyeInput {
  HandEyeMount mount = HandEyeMount::kEyeToHand;
  CameraCalibration camera;
  WristStream wrist;
  std::vector<HandEyeView> views;
};

struct HandEyeOptions {
  bool estimate_time_offset = true;  ///< where the motion shows it
  bool refine_intrinsics = false;    ///< fu, fv, cu, cv as unknowns too
  bool hold_out = true;              ///< also the error of every view when it is not used
  int max_folds = 20;                ///< in which the views are held out
  unsigned seed = 1;                 ///< of the random choice of views for the start
};

enum class HandEyeStatus { kOk, kTooFewViews, kNotConverged };

/// The result of a view. Errors are those of the chain with the wrist as measured.
struct HandEyeViewResult {
  std::string name;
  TimeNs t_ns = 0;
  bool seen = false;   ///< the board and the wrist: the numbers below mean something
  bool used = false;   ///< for the result
  std::string reason;  ///< why it was not used
  int corners = 0;
  double board_px = 0.0;  ///< RMS distance of the corners under the board's own best pose
  double px = 0.0;        ///< RMS distance of the corners from where the chain puts them
  double mm = 0.0;  ///< RMS distance in space between the chain's corners and the seen board's
  double held_out_px = 0.0, held_out_mm = 0.0;  ///< by the chain that was found without this view
  double chi2 = 0.0;     ///< of the six numbers in which chain and seen board differ
  bool flipped = false;  ///< the board's second planar pose was the right one
  /// Of the measured wrist to the fitted one, (dw, dp) in R: (rad, m).
  Vector6d wrist_step = Vector6d::Zero();
  Pose T_CB;                                       ///< as the chain has it
  std::vector<Eigen::Vector2d> px_seen, px_chain;  ///< corners, and where the chain puts them
};

/// A further view, and its gain for the camera's and the board's place.
struct HandEyeMotion {
  std::string words;
  double sd_before_m = 0.0, sd_after_m = 0.0;  ///< of a point on the board carried to F; 0: unknown
};

struct HandEyeResult {
  HandEyeStatus status = HandEyeStatus::kTooFewViews;
  std::string message;
  bool fits_other_mount = false;  ///< why it did not converge: `mount` is the wrong one
  HandEyeMount mount = HandEyeMount::kEyeToHand;
  Pose T_FC, T_KB;
  double time_offset_s = 0.0;  ///< to be added to the frames' times
  CameraCalibration camera;    ///< refined where that was asked for
  bool has_time_offset = false, has_intrinsics = false;

  /// Of T_FC (dw, dp), T_KB (dw, dp), then the time offset, then fu, fv, cu, cv, those that were
  /// fitted. Of no meaning for the parts that `unobservable` names.
  Eigen::MatrixXd covariance;
  bool knows_camera = true, knows_board = true;
  /// With "camera." , "board." or "time_offset_s" in the place of a calibration.yaml's names.
  std::vector<Calibration::Unobservable> unobservable;

  double corner_noise_px = 0.0;  ///< standard deviation an axis, as found
  /// The wrist's noise as found over the stated one, at least 1.
  double orientation_noise_scale = 1.0, position_noise_scale = 1.0;
  int views_used = 0, views_rejected = 0;
  /// RMS over the corners of the views used.
  double rms_px = 0.0, rms_mm = 0.0, held_out_px = 0.0, held_out_mm = 0.0;
  std::vector<HandEyeViewResult> views;
  std::vector<HandEyeMotion> motions;  ///< the most helpful first

  bool IsUsable() const { return status == HandEyeStatus::kOk; }
};

/// Throws InputError for a wrist without samples or a camera that is none. Everything else that
/// does not work out is a status, or a reason of a view.
///
/// Start: both planar poses of every board, chosen together (start.h). Then maximum a-posteriori
/// over both frames, the time offset and every wrist pose within its noise, from all corners; views
/// that do not fit the others are left out, worst first. The noises of corners and wrist are
/// estimated with it (variance components, Foerstner 1979). The status is also not converged where
/// half of the views disagree, and where only the other mount fits; `message` says so.
HandEyeResult CalibrateHandEye(const HandEyeInput& input, const HandEyeOptions& options = {});

/// Returns the result under the names of docs/formats.md. `board` is "board", or "tags0" for the
/// collar, which gives T_WE.
Calibration HandEyeCalibration(const HandEyeResult& result, const std::string& board = "board");

}  // namespace flextip
