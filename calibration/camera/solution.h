// The result of bundle adjustment: a camera's lens, its board and the board's places together.
#pragma once

#include <Eigen/Dense>
#include <map>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"

namespace flextip {

/// How a board that should be flat is bent: a parabola along x and one along y, as in mrcal. A
/// corner at x_B is truly at z = bulge_x (1 - u^2) + bulge_y (1 - v^2), where u and v run from -1
/// to 1 over the board's corners; z points into the board, away from who looks at it.
struct BoardWarp {
  Eigen::Vector2d bulge_m = Eigen::Vector2d::Zero();   ///< along x, along y; at the centre
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();  ///< of all corners that the board has
  Eigen::Vector2d half_m = Eigen::Vector2d::Ones();    ///< half their extent

  /// Returns 1 - u^2, 1 - v^2: the derivative of z by `bulge_m`.
  Eigen::Vector2d Shape(const Eigen::Vector3d& x_B) const {
    const Eigen::Array2d uv = (x_B.head<2>() - centre_m).array() / half_m.array();
    return (1.0 - uv * uv).matrix();
  }
  /// Returns the true place of a corner of the flat board, in B (m).
  Eigen::Vector3d Bent(const Eigen::Vector3d& x_B) const {
    return x_B + Eigen::Vector3d(0, 0, bulge_m.dot(Shape(x_B)));
  }
};

/// Where a board's corners truly are: prints are scaled and sheets have dents. Beside the warp.
struct BoardShape {
  std::map<int, Eigen::Vector3d> offset_B;  ///< by corner id, from where the warped board has it, m
  double sd_m = 0.0;  ///< prior standard deviation of each coordinate; 0: the board as described
  /// The root of the mean squared coordinate of the offsets, their own uncertainty included. The
  /// views would choose an `sd_m` that equals this value.
  double scatter_m = 0.0;

  Eigen::Vector3d Of(int id) const {
    const auto at = offset_B.find(id);
    return at == offset_B.end() ? Eigen::Vector3d::Zero() : at->second;
  }
};

/// One view: the board's pose and its corners; `ids`, `x_B`, `px`, `residual_px` and `reason` in
/// the same order.
struct SolvedView {
  std::string name;
  std::size_t index = 0;  ///< among all views given, also those that were rejected
  Pose T_CB;
  std::vector<int> ids;
  std::vector<Eigen::Vector3d> x_B;          ///< of the flat board, m
  std::vector<Eigen::Vector2d> px;           ///< as seen
  std::vector<Eigen::Vector2d> residual_px;  ///< where the solution has it less where it was seen
  std::vector<std::string> reason;           ///< why an outlier is not used; empty for the others

  bool IsUsed(std::size_t i) const { return reason[i].empty(); }
  int CountUsed() const;
  /// Returns the root of the mean squared distance (px) of the corners used, or of all.
  double RmsPx(bool with_outliers = false) const;
};

/// The coordinates of `normal_matrix` are, in this order:
///   - fu, fv, cu, cv (px), then the distortion coefficients: IntrinsicsCount() of them,
///   - the board's bulge along x and y (m): WarpCount() of them, 2 or, where the board was taken
///     for flat, 0,
///   - for each view (dw, dp), 6 numbers (rad, m): its T_CB becomes (exp([dw]x) R, p + dp).
/// A projection that moves with the poses (mrcal's: the lens and the views may trade off against
/// each other) has a Jacobian over all of them, to be multiplied with `Covariance()`.
struct CameraSolution {
  CameraCalibration camera;
  BoardWarp warp;
  bool warp_estimated = false;
  BoardShape shape;
  std::vector<SolvedView> views;  ///< those that are used

  /// Standard deviation of a corner's coordinate, from the residuals of the corners used:
  /// sqrt(sum of squares / (coordinates - parameters)); an estimated shape counts as as many
  /// parameters as the views, not its prior, determined of it.
  double noise_px = 0.0;
  /// Sum over the corners used of J^T J, J being the derivative of the pixel by the coordinates
  /// above (that is, for a noise of 1 px). Symmetric. Where the shape was estimated it is
  /// eliminated: the inverse is the covariance with the shape unknown, not fixed.
  Eigen::MatrixXd normal_matrix;

  int IntrinsicsCount() const {
    return 4 + static_cast<int>(camera.distortion_coefficients.size());
  }
  int WarpCount() const { return warp_estimated ? 2 : 0; }
  int ViewStart(std::size_t view) const {
    return IntrinsicsCount() + WarpCount() + 6 * static_cast<int>(view);
  }
  int Size() const { return ViewStart(views.size()); }
  int CornersUsed() const;
  int Outliers() const;
  /// Returns the root of the mean squared distance (px), as OpenCV gives it, over all corners used
  /// or over all corners of `views`.
  double RmsPx(bool with_outliers = false) const;

  /// Returns noise_px^2 times the inverse of `normal_matrix`. Empty where the views do not
  /// determine all of it.
  Eigen::MatrixXd Covariance() const;
};

/// Returns the inverse of a normal matrix, scaled to unit diagonal first; symmetric. Empty where
/// the matrix is singular.
Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& normal_matrix);

}  // namespace flextip
