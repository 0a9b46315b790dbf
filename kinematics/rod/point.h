// The rod at one place as its solver carries it, with its derivatives. Installed with rod.h; no
// other folder uses it.
//
// Units: length L, force EI/L^2, moment EI/L. A variation of the rod has four numbers at a place:
// (u, v) with dt = u0 y + u1 z and v the change of u by arc length from the tip. The moment's
// change follows from them (RodPoint::MomentChange).
#pragma once

#include <Eigen/Dense>

namespace flextip {

/// The solver's nine columns: the unknowns (two turns of the tip's tangent, the port's place, the
/// port's force), then the tip force.
inline constexpr int kRodColumns = 9;

struct RodPoint {
  Eigen::Vector3d t = Eigen::Vector3d::UnitX();  ///< unit tangent towards the tip
  Eigen::Vector3d y = Eigen::Vector3d::UnitY();  ///< unit, across t, carried without twist
  Eigen::Vector3d m = Eigen::Vector3d::Zero();   ///< internal moment, across t
  Eigen::Vector3d P = Eigen::Vector3d::Zero();   ///< from here to the tip

  /// Returns (y, z), the two directions across the shaft.
  Eigen::Matrix<double, 3, 2> Across() const {
    Eigen::Matrix<double, 3, 2> across;
    across << y, t.cross(y);
    return across;
  }
  /// Makes t unit and y unit and across it.
  void MakeOrthonormal() {
    t.normalize();
    y = (y - t.dot(y) * t).normalized();
  }
  /// Returns dm (3xC) of variations `uv` (4xC): v = (-dm.z, dm.y), and dm.t = -m.dt.
  template <int C>
  Eigen::Matrix<double, 3, C> MomentChange(const Eigen::Matrix<double, 4, C>& uv) const {
    const Eigen::Vector3d z = t.cross(y);
    return y * uv.row(3) - z * uv.row(2) - t * (m.dot(y) * uv.row(0) + m.dot(z) * uv.row(1));
  }
};

/// A place with its derivatives by the solver's columns.
struct RodPlace : RodPoint {
  Eigen::Matrix<double, 4, kRodColumns> uv = Eigen::Matrix<double, 4, kRodColumns>::Zero();
  Eigen::Matrix<double, 3, kRodColumns> dP = Eigen::Matrix<double, 3, kRodColumns>::Zero();
};

}  // namespace flextip
