// The instrument as it is: straight, or bent by a force on its tip (the exact rod).
#pragma once

#include <optional>

#include "kinematics/rod.h"
#include "workspace/port_instrument.h"

namespace flextip {

/// A constant force on the tip of a shaft that bends.
template <int N>
struct TipForce {
  double bending_stiffness_Nm2 = 0.0;
  VectorN<N> force_N = VectorN<N>::Zero();
};

/// The arm at one place, within its limits.
template <int N>
struct TrueState {
  VectorN<N> p_wrist = VectorN<N>::Zero(), p_tip = VectorN<N>::Zero();
  VectorN<N> theta = VectorN<N>::Zero();
  MatrixN<N> J = MatrixN<N>::Zero();  ///< d tip / d theta, the tip's force held constant
};

/// Finds wrists and tips of one instrument. Keeps the last rod as a start for the next: one of
/// these a thread, and neighbours one after the other.
template <int N>
class TrueShaft {
 public:
  TrueShaft(const PortInstrument<N>& instrument, const std::optional<TipForce<N>>& force)
      : instrument_(instrument), force_(force) {}

  /// Returns the state with the tip there. Empty where the shaft cannot be there, the arm would be
  /// outside its limits, or no bent shape is found.
  std::optional<TrueState<N>> AtTip(const VectorN<N>& p_tip);
  /// Returns the state at these joint angles, without regard to limits. Empty where the shaft does
  /// not reach the port or no bent shape is found.
  std::optional<TrueState<N>> AtJoints(const VectorN<N>& theta);

 private:
  struct Lever {
    VectorN<N> p_tip;
    MatrixN<N> J_tip_wrist;
  };
  std::optional<Lever> AtWrist(const VectorN<N>& p_wrist);
  std::optional<VectorN<N>> WristFor(const VectorN<N>& p_tip);

  PortInstrument<N> instrument_;
  std::optional<TipForce<N>> force_;
  RodSolver rod_;
};

extern template class TrueShaft<2>;
extern template class TrueShaft<3>;

}  // namespace flextip
