// How a blur that is the same all over the picture looks on a tag, and what it does as the tag
// moves.
#pragma once

#include <Eigen/Dense>

#include "core/pose.h"
#include "vision/photometric/blurred_pattern.h"

namespace flextip {

/// `to_tag`: rays (mx, my, 1) to (u w, v w, w), u and v in cells and 1/w the depth (m);
/// `spread_m`: of the rays; `middle`: of the tag, in cells, both ways, and `depth_m` its depth.
/// Exact at the middle lines; the sigmas of the others to the first order in their distance, the
/// correlation to none.
PatternBlur BlurOnTag(const Eigen::Matrix3d& to_tag, const Eigen::Matrix2d& spread_m, double middle,
                      double depth_m);

/// What a motion adds to a pixel's derivative, by the pixel's three derivatives by the blur's
/// variances (xx, xy, yy in px^2). One row for each of dw (3) and dc (3) about the pivot, and one
/// for the print offset.
using SpreadByMotion = Eigen::Matrix<double, 7, 3>;

/// In the picture the tag moves with a flow v(x), and what is blurred by S then changes by
/// -(grad . v + tr(dv/dx S Hessian)), as the mean of (x' - x) g(x') is S times that of g's
/// gradient. The pixel's own derivative is the first part; this is the second, with the flow's
/// gradient taken at the tag's middle. `T_CG`: the tag's frame; `m_of_px`: of the ray (x/z, y/z)
/// there by the pixel; `spread_px`: S.
SpreadByMotion SpreadOfTag(const Pose& T_CG, const Eigen::Vector3d& pivot_C,
                           const Eigen::Matrix2d& m_of_px, const Eigen::Matrix2d& spread_px);

}  // namespace flextip
