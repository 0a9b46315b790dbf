// An arm that holds a straight shaft through a port: in the plane (thesis 2.3.1) and in space.
// N = 2: the two-link arm, positions (z, y); N = 3: the three-joint arm, positions (x, y, z); both
// in the arm's frame A (kinematics/arm.h), in m.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <type_traits>

#include "kinematics/arm.h"

namespace flextip {

template <int N>
using VectorN = Eigen::Matrix<double, N, 1>;
template <int N>
using MatrixN = Eigen::Matrix<double, N, N>;

template <int N>
using ArmOf = std::conditional_t<N == 2, PlanarArm, PhantomArm>;

inline PlanarArm& LinksOf(PlanarArm& arm) { return arm; }
inline PlanarArm& LinksOf(PhantomArm& arm) { return arm.links; }
inline const PlanarArm& LinksOf(const PlanarArm& arm) { return arm; }
inline const PlanarArm& LinksOf(const PhantomArm& arm) { return arm.links; }

template <int N>
struct PortInstrument {
  ArmOf<N> arm;
  double shaft_m = 0.32;
  VectorN<N> p_port = N == 2 ? 0.16 * VectorN<N>::UnitX() : 0.16 * VectorN<N>::Unit(N - 1);

  /// Returns the tip (3.27): on the line from the wrist through the port, one shaft length on.
  /// Empty where the wrist is at the port or the shaft does not reach it.
  std::optional<VectorN<N>> Tip(const VectorN<N>& p_wrist) const;
  /// Returns d tip / d wrist; not for a wrist at the port.
  MatrixN<N> TipByWrist(const VectorN<N>& p_wrist) const;
  /// Returns the wrist that puts the tip there, the shaft through the port. Empty where there is
  /// none, or where the arm cannot put the wrist there within its limits.
  std::optional<VectorN<N>> WristForTip(const VectorN<N>& p_tip) const;
  /// Returns the same without regard to the arm.
  std::optional<VectorN<N>> WristOnLine(const VectorN<N>& p_tip) const;
};

extern template struct PortInstrument<2>;
extern template struct PortInstrument<3>;

}  // namespace flextip
