// The equations of the rod with effects, integrated from the wrist towards the tip by Taylor
// series, with their derivatives. Private to kinematics: the solver of effect_rod.h is the only
// user.
//
// Units: length L, force EI/L^2, moment EI/L. With s the arc length, (t, y, z) the section's axes,
// (ky, kz) the unloaded curvature and c = m/g, where g(s) is the stiffness over EI (linear, for a
// taper), the axes turn at the rate K = c + ky y + kz z, so that
//   t' = c x t - ky z + kz y,  y' = c x y - kz t,  z' = c x z + ky t,
//   m' = n x t,  P' = t,  n(s) = n0 - q s:
// polynomial, so that Taylor coefficients of any order follow from short recurrences. A variation
// turns the axes by a small vector `turn` (dt = turn x t, and so on), for which the curvature
// cancels:
//   turn' = dm/g + c x turn + dky y + dkz z,  dm' = dn x t + n x (turn x t),  dP' = turn x t.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace flextip::effect_flow {

// Chosen by timing, as in rod/flow.cpp; the derivatives need fewer terms than the states.
inline constexpr int kOrder = 18;
inline constexpr int kColumnOrder = 14;
inline constexpr double kTolerance = 1e-12;  // of the last two terms, against a unit tangent
inline constexpr int kMaxSteps = 24;

using Series = std::array<Eigen::Vector3d, kOrder + 1>;

/// The shaft at one place: the section's axes, the moment, and the way P from the wrist.
struct FlowState {
  Eigen::Vector3d t = Eigen::Vector3d::UnitX();
  Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  Eigen::Vector3d P = Eigen::Vector3d::Zero();

  /// Makes the axes orthonormal again: they drift by the truncation error.
  void MakeOrthonormal() {
    t.normalize();
    y = (y - t.dot(y) * t).normalized();
    z = t.cross(y);
  }
};

/// The load along one stretch, and its stiffness. `n0` and `stiffness` (over EI) are those at its
/// start.
struct FlowLoad {
  Eigen::Vector3d n0 = Eigen::Vector3d::Zero();
  Eigen::Vector3d q = Eigen::Vector3d::Zero();
  Eigen::Vector2d curvature = Eigen::Vector2d::Zero();
  double stiffness = 1.0, stiffness_rate = 0.0;

  double StiffnessAt(double s) const { return stiffness + stiffness_rate * s; }
  /// Returns the rate at which the axes turn, `s` from the start of the stretch.
  Eigen::Vector3d RateAt(double s, const FlowState& at) const {
    return at.m / StiffnessAt(s) + curvature.x() * at.y + curvature.y() * at.z;
  }
};

/// One step: its start (from the start of the stretch), its length and the series of the states.
struct FlowStep {
  double s0 = 0.0, h = 0.0;
  Eigen::Vector3d n0, P0;
  double g0 = 1.0, g1 = 0.0;  ///< stiffness at the start, and its rate
  Series t, y, z, m, c;

  void Expand(const FlowState& from, const FlowLoad& load);
  FlowState At(double u) const;
  /// Returns the length over which the series may be trusted: up to where its last two terms reach
  /// the tolerance.
  double TrustedLength() const;
};

inline void FlowStep::Expand(const FlowState& from, const FlowLoad& load) {
  const double ky = load.curvature.x(), kz = load.curvature.y();
  t[0] = from.t, y[0] = from.y, z[0] = from.z, m[0] = from.m;
  P0 = from.P;
  n0 = load.n0 - s0 * load.q;
  g0 = load.StiffnessAt(s0), g1 = load.stiffness_rate;
  for (int k = 0; k < kOrder; ++k) {
    c[k] = m[k] / g0;
    if (k > 0) c[k] -= g1 / g0 * c[k - 1];
    Eigen::Vector3d dt = kz * y[k] - ky * z[k], dy = -kz * t[k], dz = ky * t[k];
    for (int j = 0; j <= k; ++j) {
      dt += c[k - j].cross(t[j]);
      dy += c[k - j].cross(y[j]);
      dz += c[k - j].cross(z[j]);
    }
    Eigen::Vector3d dm = n0.cross(t[k]);
    if (k > 0) dm -= load.q.cross(t[k - 1]);
    const double part = 1.0 / (k + 1);
    t[k + 1] = part * dt, y[k + 1] = part * dy, z[k + 1] = part * dz, m[k + 1] = part * dm;
  }
}

inline double FlowStep::TrustedLength() const {
  double trusted = 1e300;
  for (const int k : {kOrder - 1, kOrder}) {
    const double size = std::max(t[k].norm(), m[k].norm());
    if (size > 0.0) trusted = std::min(trusted, std::pow(kTolerance / size, 1.0 / k));
  }
  return trusted;
}

inline FlowState FlowStep::At(double u) const {
  FlowState state{t[kOrder], y[kOrder], z[kOrder], m[kOrder], Eigen::Vector3d::Zero()};
  for (int k = kOrder - 1; k >= 0; --k) {
    state.P = u * (state.P + t[k + 1] / (k + 2));
    state.t = t[k] + u * state.t;
    state.y = y[k] + u * state.y;
    state.z = z[k] + u * state.z;
    state.m = m[k] + u * state.m;
  }
  state.P = P0 + u * (state.P + t[0]);
  state.MakeOrthonormal();
  return state;
}

/// The series of all steps of one stretch.
struct FlowPath {
  std::array<FlowStep, kMaxSteps> steps;
  int count = 0;
  FlowLoad load;
  FlowState end;

  /// Walks the stretch from `start`. Returns false where that takes more than kMaxSteps (a load far
  /// beyond buckling).
  bool Walk(const FlowState& start, const FlowLoad& along, double length);
  /// Returns the step that holds the place `s` from the start of the stretch.
  int StepOf(double s) const {
    int i = count - 1;
    while (i > 0 && steps[i].s0 > s) --i;
    return i;
  }
  FlowState At(double s) const {
    const FlowStep& step = steps[StepOf(s)];
    return step.At(s - step.s0);
  }
};

inline bool FlowPath::Walk(const FlowState& start, const FlowLoad& along, double length) {
  load = along;
  end = start;
  double done = 0.0;
  for (count = 0; count < kMaxSteps;) {
    FlowStep& step = steps[count];
    step.s0 = done;
    step.Expand(end, load);
    const double trusted = step.TrustedLength(), left = length - done;
    if (!(trusted > left / (kMaxSteps - count))) return false;  // also where it is not a number
    step.h = left / std::ceil(left / trusted);
    end = step.At(step.h);
    ++count;
    done += step.h;
    if (trusted >= left) return true;
  }
  return false;
}

inline constexpr int kMaxColumns = 14;
using ColumnMatrix = Eigen::Matrix<double, 3, kMaxColumns, Eigen::RowMajor>;

/// The variations of the states at one place: a column for each parameter.
struct FlowColumns {
  ColumnMatrix turn = ColumnMatrix::Zero(), m = ColumnMatrix::Zero(), P = ColumnMatrix::Zero();
};

/// The change by each column along the stretch: of the force at its start, of q, and of the
/// curvature.
struct FlowForcing {
  ColumnMatrix dn0 = ColumnMatrix::Zero(), dq = ColumnMatrix::Zero();
  Eigen::Matrix<double, 2, kMaxColumns, Eigen::RowMajor> dcurvature =
      Eigen::Matrix<double, 2, kMaxColumns, Eigen::RowMajor>::Zero();
};

/// Columns are carried in blocks whose sums stay in registers: the compiler's vectors, a number for
/// each column of a block. (Sanitizers check each as one access, arrays of Eigen as several.)
inline constexpr int kBlock = 2;
using Lane [[gnu::vector_size(kBlock * sizeof(double))]] = double;

/// A vector for each column of a block.
struct Lanes {
  Lane x{}, y{}, z{};

  static Lanes Load(const ColumnMatrix& from, int first) {
    Lanes v;
    for (int i = 0; i < kBlock; ++i) {
      v.x[i] = from(0, first + i), v.y[i] = from(1, first + i), v.z[i] = from(2, first + i);
    }
    return v;
  }
  void Store(ColumnMatrix& to, int first) const {
    for (int i = 0; i < kBlock; ++i) {
      to(0, first + i) = x[i], to(1, first + i) = y[i], to(2, first + i) = z[i];
    }
  }
  void AddCross(const Eigen::Vector3d& a, const Lanes& v) {
    x += a.y() * v.z - a.z() * v.y;
    y += a.z() * v.x - a.x() * v.z;
    z += a.x() * v.y - a.y() * v.x;
  }
  void SubtractCross(const Eigen::Vector3d& a, const Lanes& v) {
    x += a.z() * v.y - a.y() * v.z;
    y += a.x() * v.z - a.z() * v.x;
    z += a.y() * v.x - a.x() * v.y;
  }
  void AddTimes(const Eigen::Vector3d& a, const Lane& f) {
    x += a.x() * f, y += a.y() * f, z += a.z() * f;
  }
  Lanes operator*(double f) const { return {f * x, f * y, f * z}; }
  Lanes operator-(const Lanes& v) const { return {x - v.x, y - v.y, z - v.z}; }
  /// Multiplies by u and adds v: one step of Horner's rule.
  void Horner(double u, const Lanes& v) { x = u * x + v.x, y = u * y + v.y, z = u * z + v.z; }
};

/// The series of one block of columns over one step; `w` is turn x t, the change of t.
struct BlockSeries {
  std::array<Lanes, kColumnOrder + 1> turn, m;
  std::array<Lanes, kColumnOrder> w;

  void Expand(const FlowStep& step, const Eigen::Vector3d& q, const Lanes& dn0, const Lanes& dq,
              const Lane& dky, const Lane& dkz);
  void At(double u, Lanes& turn_at, Lanes& m_at, Lanes& P_at) const;
};

inline void BlockSeries::Expand(const FlowStep& step, const Eigen::Vector3d& q, const Lanes& dn0,
                                const Lanes& dq, const Lane& dky, const Lane& dkz) {
  Lanes dc;
  for (int k = 0; k < kColumnOrder; ++k) {
    dc = m[k] * (1.0 / step.g0) - dc * (step.g1 / step.g0);
    Lanes change, turn_next = dc, m_next;
    for (int j = 0; j <= k; ++j) {
      change.SubtractCross(step.t[k - j], turn[j]);
      turn_next.AddCross(step.c[k - j], turn[j]);
    }
    turn_next.AddTimes(step.y[k], dky);
    turn_next.AddTimes(step.z[k], dkz);
    m_next.SubtractCross(step.t[k], dn0);
    m_next.AddCross(step.n0, change);
    if (k > 0) {
      m_next.AddCross(step.t[k - 1], dq);
      m_next.SubtractCross(q, w[k - 1]);
    }
    w[k] = change;
    turn[k + 1] = turn_next * (1.0 / (k + 1));
    m[k + 1] = m_next * (1.0 / (k + 1));
  }
}

inline void BlockSeries::At(double u, Lanes& turn_at, Lanes& m_at, Lanes& P_at) const {
  Lanes turn_sum = turn[kColumnOrder], m_sum = m[kColumnOrder], P_sum;
  for (int k = kColumnOrder - 1; k >= 0; --k) {
    turn_sum.Horner(u, turn[k]);
    m_sum.Horner(u, m[k]);
    P_sum.Horner(u, w[k] * (1.0 / (k + 1)));
  }
  turn_at = turn_sum;
  m_at = m_sum;
  P_at.x += u * P_sum.x, P_at.y += u * P_sum.y, P_at.z += u * P_sum.z;
}

/// Carries the columns [first, last) along `path`: `columns` holds them at the start and then at
/// the end. `at[i]` takes them at `places[i]` from the start; a negative place is left out.
inline void CarryColumns(const FlowPath& path, const FlowForcing& forcing, int first, int last,
                         FlowColumns& columns, std::span<const double> places, FlowColumns* at) {
  BlockSeries series;
  for (int c = first; c < last; c += kBlock) {
    const Lanes dq = Lanes::Load(forcing.dq, c);
    Lanes dn0 = Lanes::Load(forcing.dn0, c), P = Lanes::Load(columns.P, c);
    Lane dky, dkz;
    for (int i = 0; i < kBlock; ++i) {
      dky[i] = forcing.dcurvature(0, c + i), dkz[i] = forcing.dcurvature(1, c + i);
    }
    series.turn[0] = Lanes::Load(columns.turn, c);
    series.m[0] = Lanes::Load(columns.m, c);
    for (int i = 0; i < path.count; ++i) {
      const FlowStep& step = path.steps[i];
      series.Expand(step, path.load.q, dn0, dq, dky, dkz);
      for (std::size_t j = 0; j < places.size(); ++j) {
        if (places[j] < 0.0 || path.StepOf(places[j]) != i) continue;
        Lanes turn_at, m_at, P_at = P;
        series.At(places[j] - step.s0, turn_at, m_at, P_at);
        turn_at.Store(at[j].turn, c);
        m_at.Store(at[j].m, c);
        P_at.Store(at[j].P, c);
      }
      series.At(step.h, series.turn[0], series.m[0], P);
      dn0.x -= step.h * dq.x, dn0.y -= step.h * dq.y, dn0.z -= step.h * dq.z;
    }
    series.turn[0].Store(columns.turn, c);
    series.m[0].Store(columns.m, c);
    P.Store(columns.P, c);
  }
}

}  // namespace flextip::effect_flow
