#include "simulation/plant/chain_port.h"

#include <algorithm>
#include <cmath>

namespace flextip::simulation {
namespace {

/// 0 to 1 over a short way, without a jump a solver could not sit on.
double Edge(double x) {
  constexpr double kWidth = 1e-3;
  const double y = std::clamp(0.5 + x / kWidth, 0.0, 1.0);
  return y * y * (3.0 - 2.0 * y);
}

}  // namespace

PortYield YieldOf(const ChainPort& port, const Eigen::Vector3d& r, const Eigen::Vector3d& t) {
  PortYield yield;
  if (port.compliance == 0.0 && port.play == 0.0) return yield;
  const Eigen::Vector3d y = Lateral(r, t);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - t * t.transpose();
  const double w = std::sqrt(y.squaredNorm() + port.play_force * port.play_force);
  yield.centre = -port.compliance * y;
  yield.shaft = yield.centre - port.play / w * y;
  yield.dshaft_dr =
      -(port.compliance + port.play / w) * across + port.play / (w * w * w) * y * y.transpose();
  return yield;
}

PortHinge HingeOf(const ChainProblem& problem, const ChainGeometry& geometry,
                  const ChainState& state) {
  const int p = problem.n1 - 1;
  const Eigen::Vector3d &one = state.u[p], &two = state.u[p + 1];
  const double h1 = geometry.h(p), h2 = geometry.h(p + 1), sum = h1 + h2;
  PortHinge hinge;
  hinge.before = h2 / sum;
  const Eigen::Vector3d v = hinge.before * one + (1.0 - hinge.before) * two;
  hinge.tangent = v.normalized();
  if (problem.port.hinge == 0.0) return hinge;
  const double g = 1.0 + problem.taper * (1.0 - 2.0 * state.s);
  const double lag = h1 * h2 / (2.0 * g * sum);
  const double k = problem.port.hinge / (1.0 + lag * problem.port.hinge);
  const double norm = v.norm();
  const Eigen::Vector3d t = v / norm, &a = problem.port.rest_axis;
  const double c = t.dot(a), sine = t.cross(a).norm(), angle = std::atan2(sine, c);
  // Derivatives of angle^2 / 2 by c; by series where the quotients lose their digits.
  const bool small = angle < 1e-3;
  const double d1 = small ? -1.0 - angle * angle / 6.0 : -angle / sine;
  const double d2 = small ? 1.0 / 3.0 : (1.0 - angle * c / sine) / (sine * sine);
  const Eigen::Vector3d w = a - c * t;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - t * t.transpose();
  hinge.gradient = k * d1 / norm * w;
  hinge.hessian =
      k / (norm * norm) *
      (d2 * w * w.transpose() - d1 * (t * w.transpose() + w * t.transpose() + c * across));
  hinge.couple = -k * d1 * t.cross(a);
  hinge.tangent = (t + lag * hinge.couple.cross(t)).normalized();
  // By s: the weights of the two links, and the lag.
  const double dh1 = geometry.dh(p), dh2 = geometry.dh(p + 1), dsum = dh1 + dh2;
  const double dbefore = (dh2 - hinge.before * dsum) / sum;
  const double dlag = ((dh1 * h2 + h1 * dh2) - h1 * h2 * dsum / sum) / (2.0 * g * sum) +
                      lag * 2.0 * problem.taper / g;
  hinge.ds = dbefore * hinge.gradient.dot(one - two) - 0.5 * k * k * angle * angle * dlag;
  hinge.slide = hinge.couple.dot(one.cross(two)) / geometry.JointLength(p) +
                (hinge.before - 0.5) * hinge.couple.squaredNorm() / g;
  return hinge;
}

double FrictionBound(const ChainFriction& friction, double s, double lateral) {
  const double bound = friction.coefficient * lateral + friction.grip;
  if (friction.from == friction.to) return bound;
  return bound * Edge(s - friction.from) * Edge(friction.to - s);
}

FrictionForce FrictionOf(const ChainFriction& friction, double s, double lateral) {
  switch (friction.mode) {
    case ChainFriction::Mode::kNone:
      return {};
    case ChainFriction::Mode::kStick:
      return {friction.stiffness * (s - friction.anchor), friction.stiffness, 0.0};
    case ChainFriction::Mode::kSlip: {
      constexpr double kStep = 1e-7;
      const double more = FrictionBound(friction, s + kStep, lateral);
      const double less = FrictionBound(friction, s - kStep, lateral);
      const double without = FrictionBound(friction, s, 0.0);
      const double bound = FrictionBound(friction, s, lateral);
      return {friction.sign * bound, friction.sign * (more - less) / (2.0 * kStep),
              lateral > 0 ? friction.sign * (bound - without) / lateral : 0.0};
    }
  }
  return {};
}

}  // namespace flextip::simulation
