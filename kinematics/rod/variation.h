// How the rod's equations follow a change of their start and of the force, over one step. Private
// to kinematics.
//
// With (t, y, z) the frame carried without twist from the tip, dt = u0 y + u1 z, M the moment's two
// parts across the shaft and N the force along it, the change u obeys a linear equation of second
// order with a symmetric matrix:
//   u'' = (N I - M M^T) u - (dn.y, dn.z).
// So four solutions without dn tell all. Their map F of (u, u') keeps F J F^T = J, from which the
// answer to a constant dn follows by quadrature: with G = (y, z) U and W the integral of G, the end
// changes by F J W^T dn, and the way to the tip by the integral of G J W^T, times dn.
#pragma once

#include <Eigen/Dense>
#include <array>

namespace flextip {

/// The map of variations from the start of a stretch to its end.
struct RodMap {
  Eigen::Matrix4d flow = Eigen::Matrix4d::Identity();                     ///< of (u, v)
  Eigen::Matrix<double, 3, 4> way = Eigen::Matrix<double, 3, 4>::Zero();  ///< of P by (u, v)
  Eigen::Matrix3d way_by_force = Eigen::Matrix3d::Zero();                 ///< of P by dn

  /// Returns J way^T.
  Eigen::Matrix<double, 4, 3> Conjugate() const {
    Eigen::Matrix<double, 4, 3> c;
    c << way.rightCols<2>().transpose(), -way.leftCols<2>().transpose();
    return c;
  }
  /// Returns the change of (u, v) at the end by dn.
  Eigen::Matrix<double, 4, 3> FlowByForce() const { return flow * Conjugate(); }
  /// Goes on by `next`, which starts where this one ends.
  void Append(const RodMap& next) {
    const Eigen::Matrix<double, 3, 4> further = next.way * flow;
    way_by_force += next.way_by_force + further * Conjugate();
    way += further;
    flow = next.flow * flow;
  }
};

/// The rod at one node of a step: the frame's two directions across, and the symmetric matrix.
struct RodNode {
  Eigen::Vector3d y, z;
  double k00, k01, k11;
};

inline constexpr int kLeastNodes = 4, kMostNodes = 8;

/// Returns the map over a step of length `h` by collocation at N Gauss nodes, kLeastNodes to
/// kMostNodes.
template <int N>
RodMap MapOfStep(const std::array<RodNode, N>& nodes, double h);

}  // namespace flextip
