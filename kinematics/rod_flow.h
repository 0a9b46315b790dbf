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
/// here to the tip, with the derivatives of each by `C` parameters.
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

// Orders and tolerance were chosen by timing: higher orders take fewer, dearer steps. The
// derivatives need fewer terms than the states for the same solution: their error is 1e-11 of their
// size.
inline constexpr int kOrder = 18;
inline constexpr int kDerivativeOrder = 14;
inline constexpr double kTolerance = 1e-12;  // of the last two terms, against a unit tangent
inline constexpr int kMaxSteps = 64;

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

/// Returns the length over which the series may be trusted: up to where its last two terms reach
/// the tolerance.
inline double TrustedLength(const Series& t, const Series& m) {
  double h = 1e300;
  for (const int k : {kOrder - 1, kOrder}) {
    const double size = std::max(t[k].norm(), m[k].norm());
    if (size > 0.0) h = std::min(h, std::pow(kTolerance / size, 1.0 / k));
  }
  return h;
}

/// Columns are carried in blocks of four whose sums stay in registers.
inline constexpr int kBlock = 4;

/// One component of one block of columns.
using Lane = Eigen::Array<double, kBlock, 1>;

/// The Taylor coefficient of one order of a derivative: a vector for each column of the block.
struct Coefficient {
  Lane x = Lane::Zero(), y = Lane::Zero(), z = Lane::Zero();

  template <class D>
  static Coefficient Load(const D& d, int first) {
    Coefficient c;
    for (int i = 0; i < kBlock && first + i < d.cols(); ++i) {
      c.x[i] = d(0, first + i), c.y[i] = d(1, first + i), c.z[i] = d(2, first + i);
    }
    return c;
  }
  template <class D>
  void Store(D& d, int first) const {
    for (int i = 0; i < kBlock && first + i < d.cols(); ++i) {
      d(0, first + i) = x[i], d(1, first + i) = y[i], d(2, first + i) = z[i];
    }
  }
  void Add(double factor, const Coefficient& c) {
    x += factor * c.x, y += factor * c.y, z += factor * c.z;
  }
  /// += a x c, column by column.
  void AddCross(const Eigen::Vector3d& a, const Coefficient& c) {
    x += a.y() * c.z - a.z() * c.y;
    y += a.z() * c.x - a.x() * c.z;
    z += a.x() * c.y - a.y() * c.x;
  }
  Coefficient operator*(double f) const { return {f * x, f * y, f * z}; }
};

/// Makes one step of the derivatives' columns from `first` on: dt' = dt x m + t x dm, dm' = dt x n
/// + t x dn.
template <int C>
void StepDerivativeBlock(const RodForce<C>& force, const Series& t, const Series& m, double h,
                         int first, RodFlow<C>& flow) {
  std::array<Coefficient, kDerivativeOrder + 1> dt, dm;
  dt[0] = Coefficient::Load(flow.dt, first);
  dm[0] = Coefficient::Load(flow.dm, first);
  const Coefficient dn0 = Coefficient::Load(force.dn0, first);
  Coefficient t_sum = dt[0], m_sum = dm[0], P_sum = Coefficient::Load(flow.dP, first);
  double power = 1.0;
  for (int k = 0; k < kDerivativeOrder; ++k) {
    Coefficient t_next, m_next;
    for (int j = 0; j <= k; ++j) {
      t_next.AddCross(t[j], dm[k - j]);
      t_next.AddCross(-m[j], dt[k - j]);
    }
    m_next.AddCross(t[k], dn0);
    m_next.AddCross(-force.n0, dt[k]);
    if (k > 0) m_next.AddCross(-force.q, dt[k - 1]);
    dt[k + 1] = t_next * (1.0 / (k + 1));
    dm[k + 1] = m_next * (1.0 / (k + 1));
    power *= h;
    P_sum.Add(power / (k + 1), dt[k]);
    t_sum.Add(power, dt[k + 1]);
    m_sum.Add(power, dm[k + 1]);
  }
  t_sum.Store(flow.dt, first);
  m_sum.Store(flow.dm, first);
  P_sum.Store(flow.dP, first);
}

}  // namespace rod_flow_internal

/// Carries `flow` over `length`. Returns false where that takes more than a bounded number of steps
/// (a load far beyond buckling). `force.n0` ends as the force at the far end.
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
    for (int c = 0; c < C; c += kBlock) StepDerivativeBlock<C>(force, t, m, h, c, flow);
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
