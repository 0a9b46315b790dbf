// The result of stereo bundle adjustment: two cameras fixed to each other, their board and the
// board's places.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "calibration/camera/solution.h"

namespace flextip {

/// One moment. `eyes` hold each camera's corners; a camera that saw nothing has none.
struct StereoView {
  std::size_t index = 0;  ///< among all pairs given
  Pose T_C0B;
  std::array<SolvedView, 2> eyes;

  bool InBoth() const { return !eyes[0].px.empty() && !eyes[1].px.empty(); }
};

/// The coordinates of `normal_matrix` are, in this order:
///   - intrinsics of camera 0, then of camera 1, as in CameraSolution,
///   - (dw, dp) of T_C0C1: it becomes (exp([dw]x) R, p + dp),
///   - the board's bulge (WarpCount() numbers),
///   - (dw, dp) of each view's T_C0B.
struct StereoSolution {
  std::array<CameraCalibration, 2> cameras;
  Pose T_C0C1;
  BoardWarp warp;
  bool warp_estimated = false;
  BoardShape shape;
  std::vector<StereoView> views;

  double noise_px = 0.0;          ///< as in CameraSolution, of both cameras together
  Eigen::MatrixXd normal_matrix;  ///< likewise: for a noise of 1 px, an estimated shape eliminated

  int IntrinsicsCount(int eye) const {
    return 4 + static_cast<int>(cameras[eye].distortion_coefficients.size());
  }
  int PairStart() const { return IntrinsicsCount(0) + IntrinsicsCount(1); }
  int WarpCount() const { return warp_estimated ? 2 : 0; }
  int ViewStart(std::size_t view) const {
    return PairStart() + 6 + WarpCount() + 6 * static_cast<int>(view);
  }
  int Size() const { return ViewStart(views.size()); }
  int CornersUsed() const;
  /// Returns the root of the mean squared distance (px) of the corners used, of both eyes (-1) or
  /// of eye 0 or 1.
  double RmsPx(int eye = -1) const;
  /// Returns the place of a corner of the board, in B (m).
  Eigen::Vector3d CornerOf(const SolvedView& eye, std::size_t i) const {
    return warp.Bent(eye.x_B[i]) + shape.Of(eye.ids[i]);
  }
  Pose T_CB(const StereoView& view, int eye) const {
    return eye == 0 ? view.T_C0B : T_C0C1.Inverse() * view.T_C0B;
  }

  /// Returns noise_px^2 times the inverse of `normal_matrix`. Empty where the views do not
  /// determine it.
  Eigen::MatrixXd Covariance() const;
};

/// The distance of the two cameras (m) and its standard deviation.
struct Baseline {
  double length_m = 0.0, sd_m = 0.0;
};
Baseline BaselineOf(const Pose& T_C0C1, const Eigen::Matrix3d& covariance_p);

}  // namespace flextip
