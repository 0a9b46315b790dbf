// The conditions of the chain's equilibrium and their derivatives: the part of ChainNewton that
// knows what acts on the shaft.
#include <algorithm>
#include <cmath>

#include "core/rotation.h"
#include "simulation/plant/chain.h"

namespace flextip::simulation {

/// Residuals and second derivatives of the Lagrangian at `state`.
void ChainNewton::Assemble(const ChainState& state) {
  const ChainGeometry geometry(problem_, state.s);
  matrix_.setZero();
  vector_.setZero();
  if (curved_) UpdateRest(problem_, state, rest_);
  if (pointed_) AssemblePoints(state, geometry);
  hinge_ = HingeOf(problem_, geometry, state);
  for (int j = 0; j < problem_.Links(); ++j) AssembleLink(j, state, geometry);
  AssembleCouplings(geometry);
  AssembleBorder(state, geometry);
  residual_ = vector_.tail<8>().squaredNorm() + vector_.head<2>().squaredNorm();
  for (int j = 0; j < problem_.Links(); ++j) {
    if (j != problem_.n1 - 1) residual_ += links_[j].residual.squaredNorm() / geometry.h(j);
  }
  residual_ = std::sqrt(residual_);
}

/// Spreads the forces at single places over the links that carry them.
void ChainNewton::AssemblePoints(const ChainState& state, const ChainGeometry& geometry) {
  std::fill(loads_.begin(), loads_.end(), LinkLoad{});
  const auto add = [&](double place, const Eigen::Vector3d& force) {
    const ChainPlace at = geometry.At(place);
    loads_[at.link].own += at.d * force;
    loads_[at.link].down += at.dd * force;
    if (at.link > 0) loads_[at.link - 1].through += force;
  };
  for (const ChainPoint& point : problem_.points) add(point.place, point.force);
  if (problem_.contact) add(problem_.contact->place, state.contact * problem_.contact->normal);
  for (int j = problem_.Links() - 2; j >= 0; --j) loads_[j].through += loads_[j + 1].through;
}

/// The gradient with respect to u_j, its derivative with respect to s, and what s itself collects.
void ChainNewton::AssembleLink(int j, const ChainState& state, const ChainGeometry& geometry) {
  const int port_link = problem_.n1 - 1, last = problem_.Links() - 1;
  const Eigen::Vector3d& u = state.u[j];
  const double h = geometry.h(j), dh = geometry.dh(j);
  Eigen::Vector3d n = state.f + geometry.beyond(j) * problem_.q;  // internal force
  if (j <= port_link) n += state.r;
  n += geometry.inside(j) * problem_.q_inside;
  if (pointed_) n += loads_[j].through;
  const Eigen::Vector3d dn =
      geometry.dbeyond(j) * problem_.q + geometry.dinside(j) * problem_.q_inside;
  if (j == 0) gradient_[j] = mixed_[j] = Eigen::Vector3d::Zero();
  gradient_[j] -= h * n;
  mixed_[j] -= dh * n + h * dn;
  vector_[kS] -= u.dot(dh * n + h * dn);
  matrix_(kS, kS) -= 2.0 * dh * u.dot(dn);
  if (pointed_) {
    gradient_[j] -= loads_[j].own;
    mixed_[j] -= loads_[j].down;
    vector_[kS] -= u.dot(loads_[j].down);
  }
  if (j < last) {
    gradient_[j + 1] = mixed_[j + 1] = Eigen::Vector3d::Zero();
    AssembleJoint(j, state, geometry);
  }
  if (j == port_link) gradient_[j] += hinge_.before * hinge_.gradient;
  if (j == port_link + 1) gradient_[j] += (1.0 - hinge_.before) * hinge_.gradient;
  Link& link = links_[j];
  link.basis = NormalBasis(u);
  link.residual = link.basis.transpose() * gradient_[j];
  link.diagonal = -u.dot(gradient_[j]) * Eigen::Matrix2d::Identity();
  link.border.setZero();
  link.border.col(kS) = link.basis.transpose() * mixed_[j];
  if (j <= port_link) link.border.block<2, 3>(0, kR) = -h * link.basis.transpose();
  link.border.block<2, 3>(0, kF) = -h * link.basis.transpose();
}

/// What the joint behind link j gives to its two links and to s.
void ChainNewton::AssembleJoint(int j, const ChainState& state, const ChainGeometry& geometry) {
  const ChainJoint joint = geometry.Joint(j);
  const Eigen::Vector3d &u = state.u[j], &v = state.u[j + 1];
  const double bend = 0.5 * (v - u).squaredNorm();  // 1 - cos, without cancellation
  gradient_[j] -= joint.bend * v;
  gradient_[j + 1] -= joint.bend * u;
  mixed_[j] -= joint.dbend * v;
  mixed_[j + 1] -= joint.dbend * u;
  vector_[kS] += joint.dbend * bend;
  matrix_(kS, kS) += joint.ddbend * bend;
  if (!curved_) return;
  const Eigen::Vector3d& b = rest_.curvature[j];
  const Eigen::Vector3d on_u = v.cross(b), on_v = b.cross(u), turn = u.cross(v);
  const Eigen::Vector3d twist = rest_.torque[j] / (1.0 + u.dot(v)) * turn;
  gradient_[j] -= joint.curve * on_u + twist;
  gradient_[j + 1] -= joint.curve * on_v + twist;
  mixed_[j] -= joint.dcurve * on_u;
  mixed_[j + 1] -= joint.dcurve * on_v;
  vector_[kS] += joint.drest - joint.dcurve * b.dot(turn);
  matrix_(kS, kS) += joint.ddrest - joint.ddcurve * b.dot(turn);
  // The torsion's energy g twist^2 / 2 length, at fixed twist.
  const double rate = rest_.twist[j] / geometry.JointLength(j);
  vector_[kS] += 0.5 * problem_.torsion * rate *
                 (geometry.StiffnessSlope(j) * rest_.twist[j] -
                  geometry.Stiffness(j) * rate * geometry.JointLengthSlope(j));
  if (j > 0) return;
  // The wrist holds the roll with a moment along its own tangent, half a link from the link's.
  gradient_[0] -= rest_.wrist_torque * WristTangent(state.u).cross(u);
  const double at_wrist = 2.0 * rest_.wrist_twist / geometry.h(0);
  vector_[kS] -=
      0.25 * problem_.torsion * geometry.Stiffness(0) * at_wrist * at_wrist * geometry.dh(0);
}

/// The couplings that need two links' bases, each to the next link toward the port.
void ChainNewton::AssembleCouplings(const ChainGeometry& geometry) {
  const int p = problem_.n1 - 1;
  for (int j = 0; j + 1 < problem_.Links(); ++j) {
    Link &one = links_[j], &two = links_[j + 1];
    const ChainJoint joint = geometry.Joint(j);
    Eigen::Matrix2d coupling = -joint.bend * one.basis.transpose() * two.basis;
    if (curved_) {
      coupling += joint.curve * one.basis.transpose() * Skew(rest_.curvature[j]) * two.basis;
    }
    if (j == p && problem_.port.hinge != 0.0) {
      const double a = hinge_.before, b = 1.0 - a;
      coupling += a * b * one.basis.transpose() * hinge_.hessian * two.basis;
      one.diagonal += a * a * one.basis.transpose() * hinge_.hessian * one.basis;
      two.diagonal += b * b * two.basis.transpose() * hinge_.hessian * two.basis;
    }
    if (j < p) {
      one.next = coupling;
    } else {
      two.next = coupling.transpose();
    }
  }
  links_[p - 1].border.leftCols<2>() = links_[p - 1].next;
  links_[p + 1].border.leftCols<2>() = links_[p + 1].next;
}

/// The conditions on s, r, f and the contact's force.
void ChainNewton::AssembleBorder(const ChainState& state, const ChainGeometry& geometry) {
  const int p = problem_.n1 - 1;
  if (problem_.contact) AssembleContact(state, geometry);
  Eigen::Vector3d sum1 = Eigen::Vector3d::Zero(), sum2 = Eigen::Vector3d::Zero();
  for (int j = 0; j <= p; ++j) sum1 += state.u[j];
  for (int j = p + 1; j < problem_.Links(); ++j) sum2 += state.u[j];
  const double h1 = geometry.h(p), h2 = geometry.h(p + 1);
  const Eigen::Vector3d x_wrist = TrueWrist(problem_, state), x_port = h1 * sum1;
  const ChainForce load =
      problem_.load(x_wrist + h1 * sum1 + h2 * sum2 + problem_.tip_compliance * state.f);
  stiffness_ = load.stiffness;

  const Link& port = links_[p];
  vector_.head<2>() = port.residual;
  matrix_.topRows<2>() = port.border;
  matrix_.topLeftCorner<2, 2>() = port.diagonal;
  matrix_.bottomLeftCorner<8, 2>() = port.border.rightCols<8>().transpose();
  const Eigen::Vector3d dsum1 = -geometry.dh(p) * sum1;
  const Eigen::Vector3d dsum = dsum1 - geometry.dh(p + 1) * sum2;
  matrix_.block<1, 3>(kS, kR) = dsum1.transpose();
  matrix_.block<3, 1>(kR, kS) = dsum1;
  matrix_.block<1, 3>(kS, kF) = dsum.transpose();
  matrix_.block<3, 1>(kF, kS) = dsum;
  vector_.segment<3>(kR) = problem_.p_port - x_wrist - x_port;
  vector_.segment<3>(kF) = load.f - state.f;
  AssembleYield(state);
  AssembleSliding(state, x_port);
}

/// The compliances of arm, port and tip.
void ChainNewton::AssembleYield(const ChainState& state) {
  const PortYield yield = YieldOf(problem_.port, state.r, hinge_.tangent);
  vector_.segment<3>(kR) += yield.shaft;
  matrix_.block<3, 3>(kR, kR) += yield.dshaft_dr;
  matrix_.block<3, 3>(kF, kF).diagonal().array() -= problem_.tip_compliance;
  const double arm = problem_.wrist_compliance;
  if (arm == 0.0) return;
  for (int row : {kR, kF}) {
    for (int column : {kR, kF}) matrix_.block<3, 3>(row, column).diagonal().array() -= arm;
    matrix_.block<3, 1>(row, kS) += arm * problem_.q_inside;
  }
  if (!problem_.contact) return;
  const Eigen::Vector3d along = arm * problem_.contact->normal;
  for (int k : {kR, kF}) {
    matrix_.block<3, 1>(k, kC) -= along;
    matrix_.block<1, 3>(kC, k) -= along.transpose();
  }
  matrix_(kC, kC) -= arm;
  matrix_(kC, kS) += along.dot(problem_.q_inside);
}

/// The condition on s: r . t_port is the friction. The derivative of the energy also has the load
/// that the part beyond the port gains with its length (of which x_port is the origin: no work),
/// and the configurational force couple . curvature with which an elastic hinge would push the
/// shaft along; a port that pushes only sideways does not.
void ChainNewton::AssembleSliding(const ChainState& state, const Eigen::Vector3d& x_port) {
  vector_[kS] += hinge_.ds + hinge_.slide - problem_.q_inside.dot(x_port);
  const ChainFriction& friction = problem_.friction;
  if (friction.mode == ChainFriction::Mode::kNone) return;
  const Eigen::Vector3d lateral = Lateral(state.r, hinge_.tangent);
  const double size = lateral.norm();
  const FrictionForce rub = FrictionOf(friction, state.s, size);
  vector_[kS] += rub.force;
  matrix_(kS, kS) += rub.ds;
  if (size > 0) matrix_.block<1, 3>(kS, kR) += rub.dlateral / size * lateral.transpose();
}

/// The second contact's force follows the depth of its place.
void ChainNewton::AssembleContact(const ChainState& state, const ChainGeometry& geometry) {
  const ChainContact& contact = *problem_.contact;
  const ChainPlace at = geometry.At(contact.place);
  Eigen::Vector3d x = TrueWrist(problem_, state), dx = Eigen::Vector3d::Zero();
  for (int j = 0; j < at.link; ++j) {
    x += geometry.h(j) * state.u[j];
    dx += geometry.dh(j) * state.u[j];
    links_[j].border.col(kC) = -geometry.h(j) * links_[j].basis.transpose() * contact.normal;
  }
  x += at.d * state.u[at.link];
  dx += at.dd * state.u[at.link];
  links_[at.link].border.col(kC) = -at.d * links_[at.link].basis.transpose() * contact.normal;
  matrix_(kS, kC) = matrix_(kC, kS) = -contact.normal.dot(dx);
  const double depth = contact.normal.dot(contact.p - x);
  const double slope = std::clamp(depth / contact.onset, 0.0, 1.0);
  contact_slope_ = contact.stiffness * slope;
  const double pushed = depth < contact.onset ? 0.5 * slope * depth : depth - 0.5 * contact.onset;
  vector_[kC] = contact.stiffness * pushed - state.contact;
}

}  // namespace flextip::simulation
