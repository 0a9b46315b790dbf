// The error measures at one place of the workspace.
#pragma once

#include "control/motion_error.h"
#include "workspace/belief.h"
#include "workspace/true_shaft.h"

namespace flextip {

enum class Measure {
  kNorm,   ///< ||G|| (2.6)
  kAngle,  ///< |phi_max| (2.9), rad
};

/// A robot, its controller's beliefs, and the controller's gain.
template <int N>
struct MapSetup {
  PortInstrument<N> truth = {};
  std::optional<TipForce<N>> force = {};
  BeliefError<N> error = {};
  double gain = 1.0;  ///< k of (2.1)
};

template <int N>
struct PointMeasures {
  VectorN<N> p_tip = VectorN<N>::Zero();
  std::optional<TrueState<N>> state;  ///< empty: not in the workspace
  std::optional<MatrixN<N>> A;        ///< k J J_hat^-1 (2.2); empty: the controller has no step
  StepError<N> step;
  AngleError<N> angle;
};

/// Measures a place where the tip's position is known and only the Jacobian is wrong, as in 2.3.2.
template <int N>
PointMeasures<N> MeasureAt(const MapSetup<N>& setup, TrueShaft<N>& shaft, const VectorN<N>& p_tip);

/// The possible errors of a motion in a direction.
enum class MotionFault {
  kNorm,   ///< |G v| / |v|: the rest after one step
  kAngle,  ///< between v and A v, rad; pi where there is no motion
  /// How far a whole move in small steps strays from its line, over its length: the largest part of
  /// exp(-A t) v square to v. The direction toward the goal turns as the tip strays, and its error
  /// with it, so this may be much more than the angle of v itself tells. 10 where it does not end.
  kStray,
};

/// Returns the error of a motion along v (not zero).
template <int N>
double DirectionError(const MatrixN<N>& A, const VectorN<N>& v, MotionFault fault);

}  // namespace flextip
