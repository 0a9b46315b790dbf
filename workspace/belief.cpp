#include "workspace/belief.h"

#include "core/check.h"

namespace flextip {
namespace {

/// The shoulder in A as the arm has it: A's origin is the wrist's home, so it moves with the links.
template <int N>
VectorN<N> Shoulder(const ArmOf<N>& arm) {
  VectorN<N> p = VectorN<N>::Zero();
  p[1] = LinksOf(arm).link2_m;
  p[N == 2 ? 0 : 2] = -LinksOf(arm).link1_m;
  return p;
}

}  // namespace

template <int N>
typename BeliefError<N>::Vector BeliefError<N>::AsVector() const {
  Vector v;
  v << port_m, links_m, joints_rad, shaft_m;
  return v;
}

template <int N>
BeliefError<N> BeliefError<N>::FromVector(const Vector& v) {
  return {.port_m = v.template head<N>(),
          .links_m = v.template segment<2>(N),
          .joints_rad = v.template segment<N>(N + 2),
          .shaft_m = v[kCount - 1]};
}

template <>
const char* ErrorName<2>(int index) {
  constexpr const char* kNames[] = {"port z",  "port y",  "link 1", "link 2",
                                    "joint 1", "joint 2", "shaft"};
  FLEXTIP_CHECK(index >= 0 && index < BeliefError<2>::kCount, "a component of the error");
  return kNames[index];
}

template <>
const char* ErrorName<3>(int index) {
  constexpr const char* kNames[] = {"port x", "port y",  "port z",  "link 1", "link 2",
                                    "base",   "joint 1", "joint 2", "shaft"};
  FLEXTIP_CHECK(index >= 0 && index < BeliefError<3>::kCount, "a component of the error");
  return kNames[index];
}

template <int N>
std::optional<BelievedState<N>> Believe(const PortInstrument<N>& truth, const BeliefError<N>& error,
                                        const VectorN<N>& theta) {
  PortInstrument<N> belief = truth;
  LinksOf(belief.arm).link1_m += error.links_m[0];
  LinksOf(belief.arm).link2_m += error.links_m[1];
  belief.shaft_m += error.shaft_m;
  // In the frame of the believed arm, whose origin has moved off A's.
  const VectorN<N> moved = Shoulder<N>(truth.arm) - Shoulder<N>(belief.arm);
  belief.p_port += error.port_m - moved;
  const VectorN<N> theta_hat = theta + error.joints_rad;
  const VectorN<N> p_wrist = belief.arm.Wrist(theta_hat);
  if (!((belief.p_port - p_wrist).norm() > 1e-12)) return std::nullopt;
  return BelievedState<N>{.p_wrist = p_wrist + moved,
                          .p_port = belief.p_port + moved,
                          .shaft_m = belief.shaft_m,
                          .J_hat = belief.TipByWrist(p_wrist) * belief.arm.Jacobian(theta_hat)};
}

template struct BeliefError<2>;
template struct BeliefError<3>;
template std::optional<BelievedState<2>> Believe(const PortInstrument<2>&, const BeliefError<2>&,
                                                 const VectorN<2>&);
template std::optional<BelievedState<3>> Believe(const PortInstrument<3>&, const BeliefError<3>&,
                                                 const VectorN<3>&);

}  // namespace flextip
