// A controller's wrong beliefs, and the Jacobian that it inverts therefore.
#pragma once

#include <optional>

#include "workspace/port_instrument.h"

namespace flextip {

/// Believed minus true. The arm's base and the port are registered in A: links that are believed
/// longer move the wrist, not the base.
template <int N>
struct BeliefError {
  static constexpr int kCount = 2 * N + 3;
  using Vector = Eigen::Matrix<double, kCount, 1>;  ///< port, links, joints, shaft

  VectorN<N> port_m = VectorN<N>::Zero();
  Eigen::Vector2d links_m = Eigen::Vector2d::Zero();
  VectorN<N> joints_rad = VectorN<N>::Zero();
  double shaft_m = 0.0;

  Vector AsVector() const;
  static BeliefError FromVector(const Vector& v);
};

/// Returns "port z", "link 1", ... for the component `index` of BeliefError<N>::Vector.
template <int N>
const char* ErrorName(int index);

/// The instrument as the controller has it, in A.
template <int N>
struct BelievedState {
  VectorN<N> p_wrist, p_port;
  double shaft_m = 0.0;
  MatrixN<N> J_hat;  ///< (2.1), d tip / d theta

  /// Returns whether the believed shaft reaches the believed port. Between a controller with and a
  /// controller without such reach lies one whose Jacobian is singular.
  bool Reaches() const { return (p_port - p_wrist).norm() < shaft_m; }
};

/// Returns the believed state at the true joint angles `theta` (rad). Empty where the believed
/// wrist is on the believed port.
template <int N>
std::optional<BelievedState<N>> Believe(const PortInstrument<N>& truth, const BeliefError<N>& error,
                                        const VectorN<N>& theta);

extern template struct BeliefError<2>;
extern template struct BeliefError<3>;

}  // namespace flextip
