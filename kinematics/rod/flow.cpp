#include "kinematics/rod/flow.h"

#include <algorithm>
#include <cmath>

#include "kinematics/rod/collocation.h"

namespace flextip {
namespace {

using gauss_collocation::kTables;

// Order and tolerance were chosen by timing: higher orders take fewer, dearer steps.
constexpr int kOrder = 20;
constexpr double kTolerance = 1e-12;  // of the last two terms, against a unit tangent
constexpr int kMaxSteps = 64;
// Two terms in a row below this one, over all that is left: the rest is below rounding. (A force
// that grows along the rod alone leaves out every third order.)
constexpr double kNothing = 1e-18;
constexpr int kLeastOrder = 8;
// Gauss's error over N nodes is the coefficient of order 2 N times (h / 4)^2N, about.
constexpr double kMapTolerance = 1e-12;

using Pair = Eigen::Array2d;

/// Two vectors side by side.
struct Pair3 {
  Pair x = Pair::Zero(), y = Pair::Zero(), z = Pair::Zero();

  static Pair3 Of(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return {{a.x(), b.x()}, {a.y(), b.y()}, {a.z(), b.z()}};
  }
  template <int I>
  Eigen::Vector3d Get() const {
    return {x[I], y[I], z[I]};
  }
  /// += a x b, pair by pair.
  void AddCross(const Pair3& a, const Pair3& b) {
    x += a.y * b.z - a.z * b.y;
    y += a.z * b.x - a.x * b.z;
    z += a.x * b.y - a.y * b.x;
  }
  Pair3 operator*(double f) const { return {f * x, f * y, f * z}; }
  /// Multiplies by u and adds v: one step of Horner's rule.
  void Horner(double u, const Pair3& v) { x = u * x + v.x, y = u * y + v.y, z = u * z + v.z; }
};

constexpr auto kInverse = [] {
  std::array<double, kOrder + 2> inverse{};
  for (int k = 1; k < kOrder + 2; ++k) inverse[k] = 1.0 / k;
  return inverse;
}();

/// The series of one step.
struct RodSeries {
  int order = kOrder;                // of the last terms that are there
  std::array<Pair3, kOrder + 1> ty;  // the tangent, and the vector across
  std::array<Pair3, kOrder + 1> mm;  // the moment, twice

  /// Takes as many terms as matter over the length `left`, kOrder at most.
  RodSeries(const RodPoint& start, const RodForce& force, double left);
  /// Returns the length, at most `left`, over which the series may be trusted: up to where its last
  /// two terms reach the tolerance. Not a number where the series is not.
  double TrustedLength(double left) const;
  RodPoint At(double u, const Eigen::Vector3d& P0) const;
  double SquaredSizeOf(int k) const {
    return std::max(ty[k].Get<0>().squaredNorm(), mm[k].Get<0>().squaredNorm());
  }
  /// Returns the size of the coefficient of order k.
  double SizeOf(int k) const { return k > order ? 0.0 : std::sqrt(SquaredSizeOf(k)); }
  /// Returns the map of variations over the step's length, with as few nodes as do.
  template <int N>
  RodMap Map(double h, const RodForce& force) const;
};

RodSeries::RodSeries(const RodPoint& start, const RodForce& force, double left) {
  ty[0] = Pair3::Of(start.t, start.y);
  mm[0] = Pair3::Of(start.m, start.m);
  double power2 = 1.0;  // of left, to twice the order
  bool last_is_nothing = false;
  for (int k = 0; k < kOrder; ++k) {
    Pair3 ty_next;
    for (int j = 0; j <= k; ++j) ty_next.AddCross(ty[j], mm[k - j]);
    Eigen::Vector3d m_next = ty[k].Get<0>().cross(force.n0);
    if (k > 0) m_next += ty[k - 1].Get<0>().cross(force.q);
    m_next *= kInverse[k + 1];
    ty[k + 1] = ty_next * kInverse[k + 1];
    mm[k + 1] = Pair3::Of(m_next, m_next);
    power2 *= left * left;
    const bool is_nothing = SquaredSizeOf(k + 1) * power2 <= kNothing * kNothing;
    if (is_nothing && last_is_nothing && k + 1 >= kLeastOrder) {
      order = k + 1;
      return;
    }
    last_is_nothing = is_nothing;
  }
}

double RodSeries::TrustedLength(double left) const {
  double trusted = left;
  if (order < kOrder) return trusted;
  for (const int k : {kOrder - 1, kOrder}) {
    const double size = SizeOf(k);
    double power = 1.0;
    for (int i = 0; i < k; ++i) power *= trusted;
    if (size * power <= kTolerance) continue;
    trusted = std::pow(kTolerance / size, 1.0 / k);
  }
  return trusted;
}

RodPoint RodSeries::At(double u, const Eigen::Vector3d& P0) const {
  Pair3 ty_sum = ty[order], mm_sum = mm[order], P_sum;
  for (int k = order - 1; k >= 0; --k) {
    P_sum.Horner(u, ty[k + 1] * kInverse[k + 2]);
    ty_sum.Horner(u, ty[k]);
    mm_sum.Horner(u, mm[k]);
  }
  P_sum.Horner(u, ty[0]);
  RodPoint point{ty_sum.Get<0>(), ty_sum.Get<1>(), mm_sum.Get<0>(), P0 + u * P_sum.Get<0>()};
  point.MakeOrthonormal();
  return point;
}

template <int N>
RodMap RodSeries::Map(double h, const RodForce& force) const {
  if constexpr (N < kMostNodes) {
    if (SizeOf(2 * N) * std::pow(0.5 * h, 2 * N) > kMapTolerance) return Map<N + 1>(h, force);
  }
  std::array<RodNode, N> nodes;
  for (int i = 0; i < N; ++i) {
    const double s = h * kTables<N>.node[i];
    Pair3 ty_sum = ty[order], mm_sum = mm[order];
    for (int k = order - 1; k >= 0; --k) {
      ty_sum.Horner(s, ty[k]);
      mm_sum.Horner(s, mm[k]);
    }
    const Eigen::Vector3d t = ty_sum.Get<0>(), m = mm_sum.Get<0>();
    RodNode& node = nodes[i];
    node.y = ty_sum.Get<1>();
    node.z = t.cross(node.y);
    const double along = t.dot(force.n0 + s * force.q), m0 = m.dot(node.y), m1 = m.dot(node.z);
    node.k00 = along - m0 * m0;
    node.k01 = -m0 * m1;
    node.k11 = along - m1 * m1;
  }
  return MapOfStep<N>(nodes, h);
}

}  // namespace

bool Advance(double length, RodForce force, RodPoint& point, RodMap* map) {
  double left = length;
  for (int step = 0; left > 0.0; ++step) {
    if (step == kMaxSteps) return false;
    const RodSeries series(point, force, left);
    const double trusted = series.TrustedLength(left);
    if (!(trusted > left / (kMaxSteps - step))) return false;  // also where it is not a number
    const double h = left / std::ceil(left / trusted);
    if (map != nullptr) map->Append(series.Map<kLeastNodes>(h, force));
    point = series.At(h, point.P);
    force.n0 += h * force.q;
    left = trusted >= left ? 0.0 : left - h;
  }
  return true;
}

}  // namespace flextip
