#include "workspace/planar_instrument.h"

#include <cassert>

namespace flextip {

std::optional<Eigen::Vector2d> PlanarInstrument::Tip(const Eigen::Vector2d& p_wrist) const {
  const Eigen::Vector2d to_port = p_port - p_wrist;
  const double distance = to_port.norm();
  if (!(distance > 0.0) || distance > shaft_m) return std::nullopt;
  return p_wrist + shaft_m / distance * to_port;
}

Eigen::Matrix2d PlanarInstrument::TipByWrist(const Eigen::Vector2d& p_wrist) const {
  const Eigen::Vector2d to_port = p_port - p_wrist;
  const double distance = to_port.norm();
  assert(distance > 0.0);
  const Eigen::Vector2d u = to_port / distance;
  // The direction turns by -(I - u u^T) / distance with the wrist.
  const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - u * u.transpose();
  return Eigen::Matrix2d::Identity() - shaft_m / distance * across;
}

std::optional<Eigen::Vector2d> PlanarInstrument::WristForTip(const Eigen::Vector2d& p_tip) const {
  const Eigen::Vector2d to_port = p_port - p_tip;
  const double distance = to_port.norm();
  if (!(distance > 0.0) || distance > shaft_m) return std::nullopt;
  const Eigen::Vector2d p_wrist = p_tip + shaft_m / distance * to_port;
  if (arm.Solve(p_wrist).status != ArmStatus::kOk) return std::nullopt;
  return p_wrist;
}

}  // namespace flextip
