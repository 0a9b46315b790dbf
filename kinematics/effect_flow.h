// The equations of the rod with effects, integrated from the wrist towards the tip by Taylor
// series. Their derivatives are in effect_columns.h. Private to kinematics: the solver of
// effect_rod.h is the only user.
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

}  // namespace flextip::effect_flow
