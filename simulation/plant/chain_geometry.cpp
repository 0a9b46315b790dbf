#include "simulation/plant/chain_geometry.h"

#include <algorithm>
#include <cmath>

namespace flextip::simulation {

Eigen::Vector3d ForceOnArm(const ChainProblem& problem, const ChainState& state) {
  Eigen::Vector3d sum = state.r + state.f + problem.q + (1.0 - state.s) * problem.q_inside;
  for (const ChainPoint& point : problem.points) sum += point.force;
  if (problem.contact) sum += state.contact * problem.contact->normal;
  return sum;
}

ChainGeometry::ChainGeometry(const ChainProblem& problem, double s)
    : n1_(problem.n1),
      n2_(problem.n2),
      h1_(s / problem.n1),
      h2_((1.0 - s) / problem.n2),
      dh1_(1.0 / problem.n1),
      dh2_(-1.0 / problem.n2),
      s_(s),
      taper_(problem.taper),
      k_(problem.curvature.norm()) {
  const double length[3] = {h1_, 0.5 * (h1_ + h2_), h2_};
  const double dlength[3] = {dh1_, 0.5 * (dh1_ + dh2_), dh2_};
  for (int i = 0; i < 3; ++i) {
    kinds_[i] = {length[i], dlength[i], std::cos(k_ * length[i]), std::sin(k_ * length[i])};
    joints_[i] = MakeJoint(kinds_[i], 1.0, 0.0);
  }
}

double ChainGeometry::beyond(int link) const {
  return link < n1_ ? 1.0 - h1_ * (link + 0.5) : h2_ * (n1_ + n2_ - link - 0.5);
}

double ChainGeometry::dbeyond(int link) const {
  return link < n1_ ? -dh1_ * (link + 0.5) : dh2_ * (n1_ + n2_ - link - 0.5);
}

/// With c the stiffness g over the length j and b = k j: bend = c cos b, curve = c sin(b) / k,
/// rest = c (1 - cos b); j and g are linear in s.
ChainJoint ChainGeometry::MakeJoint(const Kind& kind, double g, double dg) const {
  const double j = kind.length, dj = kind.dlength;
  const double c = g / j, dc = dg / j - g * dj / (j * j);
  const double ddc = 2.0 * g * dj * dj / (j * j * j) - 2.0 * dg * dj / (j * j);
  ChainJoint joint;
  if (k_ == 0.0) {
    joint.bend = c, joint.dbend = dc, joint.ddbend = ddc;
    return joint;
  }
  const double kd = k_ * dj, co = kind.cosine, si = kind.sine;
  joint.bend = c * co;
  joint.dbend = dc * co - c * kd * si;
  joint.ddbend = ddc * co - 2.0 * dc * kd * si - c * kd * kd * co;
  joint.curve = c * si / k_;
  joint.dcurve = (dc * si + c * kd * co) / k_;
  joint.ddcurve = (ddc * si + 2.0 * dc * kd * co - c * kd * kd * si) / k_;
  joint.drest = dc - joint.dbend;
  joint.ddrest = ddc - joint.ddbend;
  return joint;
}

ChainJoint ChainGeometry::Joint(int link) const {
  const int kind = link < n1_ - 1 ? 0 : link == n1_ - 1 ? 1 : 2;
  if (taper_ == 0.0) return joints_[kind];
  return MakeJoint(kinds_[kind], Stiffness(link), StiffnessSlope(link));
}

double ChainGeometry::JointPlace(int link) const {
  return link < n1_ ? (link + 1) * h1_ : s_ + (link - n1_ + 1) * h2_;
}

double ChainGeometry::StiffnessSlope(int link) const {
  const double dplace = link < n1_ ? (link + 1) * dh1_ : 1.0 + (link - n1_ + 1) * dh2_;
  return -2.0 * taper_ * dplace;
}

ChainPlace ChainGeometry::At(double place) const {
  if (place < s_) {
    const int i = std::clamp(static_cast<int>(place / h1_), 0, n1_ - 1);
    return {i, place - i * h1_, -i * dh1_};
  }
  const int i = std::clamp(static_cast<int>((place - s_) / h2_), 0, n2_ - 1);
  return {n1_ + i, place - s_ - i * h2_, -1.0 - i * dh2_};
}

std::vector<Eigen::Vector3d> ChainNodes(const ChainProblem& problem, const ChainState& state) {
  const ChainGeometry geometry(problem, state.s);
  std::vector<Eigen::Vector3d> nodes{TrueWrist(problem, state)};
  nodes.reserve(state.u.size() + 1);
  for (int j = 0; j < problem.Links(); ++j) {
    nodes.emplace_back(nodes.back() + geometry.h(j) * state.u[j]);
  }
  return nodes;
}

}  // namespace flextip::simulation
