#include "simulation/arm/dynamic_arm.h"

#include <algorithm>
#include <cmath>

namespace flextip::simulation {
namespace {

/// Where the shaft is for a wrist: straight through the port.
struct ShaftPlace {
  double distance_m;      // from wrist to port
  Eigen::Vector2d along;  // unit, toward the port
  Eigen::Vector2d across;
};

ShaftPlace Place(const PortedShaft& shaft, const Eigen::Vector2d& p_wrist) {
  const Eigen::Vector2d to_port = shaft.p_port - p_wrist;
  const double distance = to_port.norm();
  const Eigen::Vector2d along = to_port / distance;
  return {distance, along, Eigen::Vector2d(-along.y(), along.x())};
}

/// d (middle of the shaft) / d wrist: the shaft swings about the port.
Eigen::Matrix2d MiddleByWrist(const PortedShaft& shaft, const ShaftPlace& place) {
  return Eigen::Matrix2d::Identity() -
         0.5 * shaft.length_m / place.distance_m * place.across * place.across.transpose();
}

}  // namespace

Eigen::Vector2d DynamicArm::Wrist(const Eigen::Vector2d& angles) const {
  return {body_.link1_m * (std::cos(angles[0]) - 1.0) + body_.link2_m * std::sin(angles[1]),
          body_.link1_m * std::sin(angles[0]) + body_.link2_m * (1.0 - std::cos(angles[1]))};
}

Eigen::Matrix2d DynamicArm::Jacobian(const Eigen::Vector2d& angles) const {
  Eigen::Matrix2d J;
  J.col(0) = body_.link1_m * Eigen::Vector2d(-std::sin(angles[0]), std::cos(angles[0]));
  J.col(1) = body_.link2_m * Eigen::Vector2d(std::cos(angles[1]), std::sin(angles[1]));
  return J;
}

Eigen::Matrix2d DynamicArm::MassMatrix(const Eigen::Vector2d& angles) const {
  const Eigen::Matrix2d J = Jacobian(angles);
  Eigen::Matrix2d at_wrist = body_.wrist_mass_kg * Eigen::Matrix2d::Identity();
  if (shaft_) {
    const ShaftPlace place = Place(*shaft_, Wrist(angles));
    const Eigen::Matrix2d middle = MiddleByWrist(*shaft_, place);
    const double inertia = shaft_->mass_kg * shaft_->length_m * shaft_->length_m / 12.0;
    at_wrist +=
        shaft_->mass_kg * middle.transpose() * middle +
        inertia / (place.distance_m * place.distance_m) * place.across * place.across.transpose();
  }
  Eigen::Matrix2d M = J.transpose() * at_wrist * J;
  M(0, 0) += body_.inertia1_kg_m2;
  M(1, 1) += body_.inertia2_kg_m2;
  return M;
}

Eigen::Vector2d DynamicArm::GravityTorque(const Eigen::Vector2d& angles) const {
  if (!shaft_) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d weight(0.0, -shaft_->mass_kg * shaft_->gravity_m_s2);
  const Eigen::Matrix2d middle = MiddleByWrist(*shaft_, Place(*shaft_, Wrist(angles)));
  return -(middle * Jacobian(angles)).transpose() * weight;
}

double DynamicArm::Sliding(const Eigen::Vector2d& angles) const {
  return Place(*shaft_, Wrist(angles)).distance_m;
}

Eigen::RowVector2d DynamicArm::SlidingRate(const Eigen::Vector2d& angles) const {
  return -Place(*shaft_, Wrist(angles)).along.transpose() * Jacobian(angles);
}

double DynamicArm::KineticEnergy(const ArmState& state) const {
  return 0.5 * state.rates.dot(MassMatrix(state.angles) * state.rates);
}

/// What the changing mass matrix takes (Lagrange): dM/dt v - 1/2 d(v^T M v)/dq, by central
/// differences.
Eigen::Vector2d DynamicArm::VelocityForces(const ArmState& state) const {
  constexpr double kStep_rad = 1e-5;
  const Eigen::Vector2d& v = state.rates;
  Eigen::Vector2d change = Eigen::Vector2d::Zero();
  Eigen::Vector2d gradient;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = kStep_rad * Eigen::Vector2d::Unit(i);
    const Eigen::Matrix2d dM =
        (MassMatrix(state.angles + step) - MassMatrix(state.angles - step)) / (2.0 * kStep_rad);
    change += v[i] * dM * v;
    gradient[i] = v.dot(dM * v);
  }
  return change - 0.5 * gradient;
}

void DynamicArm::Step(ArmState& state, const Eigen::Vector2d& torque_Nm,
                      const Eigen::Vector2d& f_wrist_N, double dt_s) const {
  const Eigen::Matrix2d M_inverse = MassMatrix(state.angles).inverse();
  const Eigen::Vector2d torque = torque_Nm + Jacobian(state.angles).transpose() * f_wrist_N -
                                 GravityTorque(state.angles) - VelocityForces(state);
  state.rates += dt_s * M_inverse * torque;
  if (shaft_ && shaft_->friction_N > 0.0) {
    const Eigen::RowVector2d j = SlidingRate(state.angles);
    const double stopping = -j.dot(state.rates) / (j * M_inverse * j.transpose());
    const double bound = shaft_->friction_N * dt_s;
    state.rates += M_inverse * j.transpose() * std::clamp(stopping, -bound, bound);
  }
  state.angles += dt_s * state.rates;
}

}  // namespace flextip::simulation
