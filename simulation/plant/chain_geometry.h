// Lengths, stiffnesses and places on the chain for a given s of the port, with their derivatives
// with respect to s.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "simulation/plant/chain_problem.h"

namespace flextip::simulation {

/// One joint's energy is C (1 - cos(b) u.u' - sin(b)/k B.(u x u')), with C its stiffness over the
/// length it stands for, b = k length its unloaded bend, and B the unloaded curvature vector, |B| =
/// k: zero where u' is u turned by b about B. Here as rest + bend (1 - u.u') - curve B.(u x u').
struct ChainJoint {
  double bend = 0.0, dbend = 0.0, ddbend = 0.0;
  double curve = 0.0, dcurve = 0.0, ddcurve = 0.0;
  double drest = 0.0, ddrest = 0.0;
};

/// A place on the shaft: in `link`, `d` along it; `dd` is the derivative of d by s.
struct ChainPlace {
  int link = 0;
  double d = 0.0, dd = 0.0;
};

class ChainGeometry {
 public:
  ChainGeometry(const ChainProblem& problem, double s);

  double h(int link) const { return link < n1_ ? h1_ : h2_; }
  double dh(int link) const { return link < n1_ ? dh1_ : dh2_; }
  /// Returns the length of shaft (m) beyond the middle of `link`, whose weight that section
  /// carries.
  double beyond(int link) const;
  double dbeyond(int link) const;
  /// Returns the part of that length that is beyond the port too.
  double inside(int link) const { return link < n1_ ? n2_ * h2_ : beyond(link); }
  double dinside(int link) const { return link < n1_ ? n2_ * dh2_ : dbeyond(link); }
  /// Returns the joint between `link` and the next one.
  ChainJoint Joint(int link) const;
  double JointLength(int link) const { return 0.5 * (h(link) + h(link + 1)); }
  double JointLengthSlope(int link) const { return 0.5 * (dh(link) + dh(link + 1)); }
  /// Returns the shaft's stiffness at that joint, over the mean stiffness.
  double Stiffness(int link) const { return 1.0 + taper_ * (1.0 - 2.0 * JointPlace(link)); }
  double StiffnessSlope(int link) const;
  ChainPlace At(double place) const;

 private:
  struct Kind {  // the joints before, at and behind the port each have one length
    double length = 0.0, dlength = 0.0, cosine = 1.0, sine = 0.0;
  };
  double JointPlace(int link) const;
  ChainJoint MakeJoint(const Kind& kind, double g, double dg) const;

  int n1_, n2_;
  double h1_, h2_, dh1_, dh2_;
  double s_, taper_, k_;
  Kind kinds_[3];
  ChainJoint joints_[3];  // without taper
};

/// Returns the positions of the chain's nodes, true wrist to tip: n1 + n2 + 1 of them.
std::vector<Eigen::Vector3d> ChainNodes(const ChainProblem& problem, const ChainState& state);

}  // namespace flextip::simulation
