#include "workspace/port_instrument.h"

#include "core/check.h"

namespace flextip {

template <int N>
std::optional<VectorN<N>> PortInstrument<N>::Tip(const VectorN<N>& p_wrist) const {
  const VectorN<N> to_port = p_port - p_wrist;
  const double distance = to_port.norm();
  if (!(distance > 0.0) || distance > shaft_m) return std::nullopt;
  return p_wrist + shaft_m / distance * to_port;
}

template <int N>
MatrixN<N> PortInstrument<N>::TipByWrist(const VectorN<N>& p_wrist) const {
  const VectorN<N> to_port = p_port - p_wrist;
  const double distance = to_port.norm();
  FLEXTIP_CHECK(distance > 0.0, "the wrist is off the port");
  const VectorN<N> u = to_port / distance;
  // The direction turns by -(I - u u^T) / distance with the wrist.
  const MatrixN<N> across = MatrixN<N>::Identity() - u * u.transpose();
  return MatrixN<N>::Identity() - shaft_m / distance * across;
}

template <int N>
std::optional<VectorN<N>> PortInstrument<N>::WristOnLine(const VectorN<N>& p_tip) const {
  const VectorN<N> to_port = p_port - p_tip;
  const double distance = to_port.norm();
  if (!(distance > 0.0) || !(distance < shaft_m)) return std::nullopt;
  return p_tip + shaft_m / distance * to_port;
}

template <int N>
std::optional<VectorN<N>> PortInstrument<N>::WristForTip(const VectorN<N>& p_tip) const {
  const auto p_wrist = WristOnLine(p_tip);
  if (!p_wrist || arm.Solve(*p_wrist).status != ArmStatus::kOk) return std::nullopt;
  return p_wrist;
}

template struct PortInstrument<2>;
template struct PortInstrument<3>;

}  // namespace flextip
