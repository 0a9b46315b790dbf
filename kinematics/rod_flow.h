// The rod's equations integrated from the tip towards the wrist by Taylor series, with their
// derivatives. Private to kinematics: the rod's solver is the only user.
//
// Units: length L, force EI/L^2, moment EI/L. With sigma the arc length from the tip,
//   dt/dsigma = t x m,  dm/dsigma = t x n,  dP/dsigma = t,  n(sigma) = n0 + q sigma:
// polynomial, so the Taylor coefficients of any order follow from short recurrences (no table of
// magic coefficients, and the step length follows from the last coefficients themselves).
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace flextip {

/// State at one place: unit tangent t (towards the tip), internal moment m, and P, the vector from
/// here to the tip; with the derivatives of each with respect to `C` parameters.
template <int C>
struct RodFlow {
  using Derivative = Eigen::Matrix<double, 3, C, C == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
  Eigen::Vector3d t = Eigen::Vector3d::UnitX();
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  Eigen::Vector3d P = Eigen::Vector3d::Zero();
  Derivative dt = Derivative::Zero(), dm = Derivative::Zero(), dP = Derivative::Zero();
};

/// The internal force along one stretch: n(u) = n0 + q u, with dn0 the derivative of n0.
template <int C>
struct RodForce {
  Eigen::Vector3d n0 = Eigen::Vector3d::Zero();
  Eigen::Vector3d q = Eigen::Vector3d::Zero();
  typename RodFlow<C>::Derivative dn0 = RodFlow<C>::Derivative::Zero();
};

namespace rod_flow_internal {

inline constexpr int kOrder = 12;
inline constexpr double kTolerance = 1e-15;  // of the last two terms, against a unit tangent
inline constexpr int kMaxSteps = 64;

/// out += a x B, column by column.
template <class D>
void AddCross(const Eigen::Vector3d& a, const D& B, D& out) {
  out.row(0) += a.y() * B.row(2) - a.z() * B.row(1);
  out.row(1) += a.z() * B.row(0) - a.x() * B.row(2);
  out.row(2) += a.x() * B.row(1) - a.y() * B.row(0);
}

using Series = std::array<Eigen::Vector3d, kOrder + 1>;

inline void ExpandState(const Eigen::Vector3d& n0, const Eigen::Vector3d& q, Series& t, Series& m) {
  for (int k = 0; k < kOrder; ++k) {
    Eigen::Vector3d t_next = Eigen::Vector3d::Zero();
    for (int j = 0; j <= k; ++j) t_next += t[j].cross(m[k - j]);
    Eigen::Vector3d m_next = t[k].cross(n0);
    if (k > 0) m_next += t[k - 1].cross(q);
    t[k + 1] = t_next / (k + 1);
    m[k + 1] = m_next / (k + 1);
  }
}

/// How far the series may be trusted: where its last two terms reach the tolerance.
inline double TrustedLength(const Series& t, const Series& m) {
  double h = 1e300;
  for (const int k : {kOrder - 1, kOrder}) {
    const double size = std::max(t[k].norm(), m[k].norm());
    if (size > 0.0) h = std::min(h, std::pow(kTolerance / size, 1.0 / k));
  }
  return h;
}

template <int C>
void StepDerivatives(const RodForce<C>& force, const Series& t, const Series& m, double h,
                     RodFlow<C>& flow) {
  using D = typename RodFlow<C>::Derivative;
  std::array<D, kOrder + 1> dt, dm;
  dt[0] = flow.dt;
  dm[0] = flow.dm;
  D dP = flow.dP, t_sum = flow.dt, m_sum = flow.dm;
  double power = 1.0;
  for (int k = 0; k < kOrder; ++k) {
    D t_next = D::Zero(), m_next = D::Zero();
    for (int j = 0; j <= k; ++j) {
      AddCross<D>(t[j], dm[k - j], t_next);
      AddCross<D>(-m[k - j], dt[j], t_next);
    }
    AddCross<D>(-force.n0, dt[k], m_next);
    AddCross<D>(t[k], force.dn0, m_next);
    if (k > 0) AddCross<D>(-force.q, dt[k - 1], m_next);
    dt[k + 1] = t_next / (k + 1);
    dm[k + 1] = m_next / (k + 1);
    power *= h;
    dP += (power / (k + 1)) * dt[k];
    t_sum += power * dt[k + 1];
    m_sum += power * dm[k + 1];
  }
  flow.dt = t_sum;
  flow.dm = m_sum;
  flow.dP = dP;
}

}  // namespace rod_flow_internal

/// Carries `flow` over `length`; false where that takes more than a bounded number of steps (a
/// load far beyond buckling). `force.n0` ends as the force at the far end.
template <int C>
bool Advance(double length, RodForce<C>& force, RodFlow<C>& flow) {
  using namespace rod_flow_internal;
  Series t, m;
  double left = length;
  for (int step = 0; left > 0.0; ++step) {
    if (step == kMaxSteps) return false;
    t[0] = flow.t;
    m[0] = flow.m;
    ExpandState(force.n0, force.q, t, m);
    const double trusted = TrustedLength(t, m);
    if (!(trusted > left / (kMaxSteps - step))) return false;  // also where it is not a number
    const double h = left / std::ceil(left / trusted);
    StepDerivatives<C>(force, t, m, h, flow);
    double power = 1.0;
    for (int k = 0; k < kOrder; ++k) {
      power *= h;
      flow.P += (power / (k + 1)) * t[k];
      flow.t += power * t[k + 1];
      flow.m += power * m[k + 1];
    }
    flow.t.normalize();
    force.n0 += h * force.q;
    left = trusted >= left ? 0.0 : left - h;
  }
  return true;
}

}  // namespace flextip
