// A blur that is the same all over the picture, seen on a tag: its spread there, and its change as
// the tag moves.
#pragma once

#include <Eigen/Dense>

#include "core/pose.h"
#include "vision/photometric/blurred_pattern.h"

namespace flextip {

/// Returns the blur on a tag, in cells. `to_tag` takes rays (mx, my, 1) to (u w, v w, w), u and v
/// in cells and 1/w the depth (m). `spread_m` is the covariance of the rays, `middle` the tag's
/// middle (cells, both ways), `depth_m` its depth. Exact at the middle lines. The sigmas of the
/// others are right to first order in their distance; the correlation is that of the middle.
PatternBlur BlurOnTag(const Eigen::Matrix3d& to_tag, const Eigen::Matrix2d& spread_m, double middle,
                      double depth_m);

/// The part of a pixel's derivative by a motion that comes from the pixel's three derivatives by
/// the blur's variances (xx, xy, yy in px^2). One row for each of dw (3) and dc (3) about the
/// pivot, and one for the print offset.
using SpreadByMotion = Eigen::Matrix<double, 7, 3>;

/// Returns the change of the blur as the tag moves. In the picture the tag moves with a flow v(x).
/// A pattern blurred by S then changes by -(grad . v + tr(dv/dx S Hessian)), as the mean of (x' -
/// x) g(x') is S times that of g's gradient. The first part is the pixel's own derivative; this is
/// the second, with the flow's gradient at the tag's middle. `T_CG` is the tag's frame, `m_of_px`
/// the derivative of the ray (x/z, y/z) there by the pixel, `spread_px` S (px^2).
SpreadByMotion SpreadOfTag(const Pose& T_CG, const Eigen::Vector3d& pivot_C,
                           const Eigen::Matrix2d& m_of_px, const Eigen::Matrix2d& spread_px);

}  // namespace flextip
