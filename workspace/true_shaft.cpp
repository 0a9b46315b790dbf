#include "workspace/true_shaft.h"

#include <algorithm>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

Eigen::Vector3d InSpace(const Eigen::Vector2d& zy) { return {0.0, zy.y(), zy.x()}; }
Eigen::Vector3d InSpace(const Eigen::Vector3d& p) { return p; }

template <int N>
VectorN<N> FromSpace(const Eigen::Vector3d& p) {
  if constexpr (N == 2) {
    return {p.z(), p.y()};
  } else {
    return p;
  }
}

template <int N>
MatrixN<N> FromSpace(const Eigen::Matrix3d& J) {
  if constexpr (N == 2) {
    MatrixN<2> out;
    out << J(2, 2), J(2, 1), J(1, 2), J(1, 1);
    return out;
  } else {
    return J;
  }
}

}  // namespace

template <int N>
auto TrueShaft<N>::AtWrist(const VectorN<N>& p_wrist) -> std::optional<Lever> {
  if (!force_) {
    const auto p_tip = instrument_.Tip(p_wrist);
    if (!p_tip) return std::nullopt;
    return Lever{*p_tip, instrument_.TipByWrist(p_wrist)};
  }
  const RodState rod = rod_.Solve({.length_m = instrument_.shaft_m,
                                   .bending_stiffness_Nm2 = force_->bending_stiffness_Nm2,
                                   .p_wrist = InSpace(p_wrist),
                                   .p_port = InSpace(instrument_.p_port),
                                   .f_tip = InSpace(force_->force_N)});
  if (!rod.IsUsable()) return std::nullopt;
  return Lever{FromSpace<N>(rod.tip.p), FromSpace<N>(rod.J_tip_wrist())};
}

/// Newton from the straight shaft's wrist, in steps that keep the wrist off the port.
template <int N>
std::optional<VectorN<N>> TrueShaft<N>::WristFor(const VectorN<N>& p_tip) {
  auto p_wrist = instrument_.WristOnLine(p_tip);
  if (!force_ || !p_wrist) return p_wrist;
  constexpr int kSteps = 30;
  constexpr double kClose_m = 1e-10;
  for (int i = 0; i < kSteps; ++i) {
    const auto lever = AtWrist(*p_wrist);
    if (!lever) return std::nullopt;
    const VectorN<N> missing = p_tip - lever->p_tip;
    if (missing.norm() < kClose_m) return p_wrist;
    const VectorN<N> step = Lu(lever->J_tip_wrist).Solve(missing);
    const double distance = (instrument_.p_port - *p_wrist).norm();
    const double longest =
        0.5 * std::min(distance, std::max(instrument_.shaft_m - distance, 0.02 * distance));
    if (!step.allFinite()) return std::nullopt;
    *p_wrist += step * std::min(1.0, longest / std::max(step.norm(), 1e-300));
  }
  return std::nullopt;
}

template <int N>
std::optional<TrueState<N>> TrueShaft<N>::AtTip(const VectorN<N>& p_tip) {
  const auto p_wrist = WristFor(p_tip);
  if (!p_wrist) return std::nullopt;
  const auto joints = instrument_.arm.Solve(*p_wrist);
  if (joints.status != ArmStatus::kOk) return std::nullopt;
  auto state = AtJoints(joints.theta);
  if (state) state->p_tip = p_tip;
  return state;
}

template <int N>
std::optional<TrueState<N>> TrueShaft<N>::AtJoints(const VectorN<N>& theta) {
  const VectorN<N> p_wrist = instrument_.arm.Wrist(theta);
  const auto lever = AtWrist(p_wrist);
  if (!lever) return std::nullopt;
  return TrueState<N>{.p_wrist = p_wrist,
                      .p_tip = lever->p_tip,
                      .theta = theta,
                      .J = lever->J_tip_wrist * instrument_.arm.Jacobian(theta)};
}

template class TrueShaft<2>;
template class TrueShaft<3>;

}  // namespace flextip
