#include "calibration/shaft/stiffness_rod.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "kinematics/load_steps.h"

namespace flextip {
namespace {

using namespace tapered_input;

constexpr int kUnknowns = 6;  // two turns of the wrist's tangent, the port's place, its force
constexpr int kSteps = 16;    // along the whole shaft, at least
constexpr int kMaxNewton = 20;
constexpr double kConverged = 1e-11;
constexpr double kMostTurn = 0.4;  // rad, in one Newton step
constexpr double kLeastStretch = 1e-4;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// The problem in units of L and EI, with whatever derivatives T carries.
template <class T>
struct Scaled {
  Vector3<T> span, f, q, y_wrist;
  T taper;
};

/// Place from the wrist, tangent, y axis, moment.
template <class T>
using State = Eigen::Matrix<T, 12, 1>;

template <class T>
State<T> Rate(const Scaled<T>& problem, const State<T>& x, const T& s, const Vector3<T>& r) {
  const Vector3<T> t = x.template segment<3>(3), y = x.template segment<3>(6);
  const T stiffness = T(1) + problem.taper * (s - T(0.5));
  const Vector3<T> kappa = x.template tail<3>() / stiffness;
  const Vector3<T> n = problem.f + problem.q * (T(1) - s) + r;
  State<T> rate;
  rate << t, kappa.cross(t), kappa.cross(y), n.cross(t);
  return rate;
}

template <class T>
void Walk(const Scaled<T>& problem, const T& from, const T& to, const Vector3<T>& r, State<T>& x) {
  const double length = to.a - from.a;
  const int steps = std::max(1, static_cast<int>(std::ceil(length * kSteps)));
  const T h = (to - from) / T(steps);
  for (int i = 0; i < steps; ++i) {
    const T s = from + h * T(i);
    const State<T> k1 = Rate(problem, x, s, r);
    const State<T> k2 = Rate<T>(problem, x + k1 * (h * T(0.5)), s + h * T(0.5), r);
    const State<T> k3 = Rate<T>(problem, x + k2 * (h * T(0.5)), s + h * T(0.5), r);
    const State<T> k4 = Rate<T>(problem, x + k3 * h, s + h, r);
    x += (k1 + (k2 + k3) * T(2) + k4) * (h / T(6));
  }
}

/// One walk along the shaft: the states at wrist, stations and tip, and what the conditions leave.
template <class T>
struct Shot {
  State<T> wrist, tip;
  std::vector<State<T>> stations;
  Eigen::Matrix<T, kUnknowns, 1> residual;

  void Shoot(const Scaled<T>& problem, const Vector3<T>& t_wrist, const T& s_port,
             const Vector3<T>& r, std::span<const double> places);
};

template <class T>
void Shot<T>::Shoot(const Scaled<T>& problem, const Vector3<T>& t_wrist, const T& s_port,
                    const Vector3<T>& r, std::span<const double> places) {
  const Vector3<T> y = problem.y_wrist - t_wrist * problem.y_wrist.dot(t_wrist);
  wrist.setConstant(T(0));
  wrist.template segment<3>(3) = t_wrist;
  wrist.template segment<3>(6) = y / sqrt(y.squaredNorm());
  std::vector<std::size_t> order(places.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return places[a] < places[b]; });
  stations.resize(places.size());
  const Vector3<T> none = Vector3<T>::Constant(T(0));
  State<T> x = wrist, at_port = wrist;
  T s = T(0);
  bool beyond = false;
  const auto pass_port = [&] {
    Walk(problem, s, s_port, r, x);
    at_port = x;
    s = s_port;
    beyond = true;
  };
  for (const std::size_t i : order) {
    if (!beyond && places[i] > s_port.a) pass_port();
    const T place = T(places[i]);
    Walk(problem, s, place, beyond ? none : r, x);
    stations[i] = x;
    s = place;
  }
  if (!beyond) pass_port();
  Walk(problem, s, T(1), none, x);
  tip = x;
  Eigen::Vector3d t_tip;
  for (int i = 0; i < 3; ++i) t_tip[i] = tip[3 + i].a;
  const Eigen::Matrix<double, 3, 2> across = NormalBasis(t_tip.normalized());
  residual.template head<3>() = at_port.template head<3>() - problem.span;
  residual.template segment<2>(3) = across.transpose().template cast<T>() * tip.template tail<3>();
  residual[5] = r.dot(at_port.template segment<3>(3));
}

/// The problem with its inputs as variables `first`, `first` + 1, ... of T; none where negative.
template <class T>
Scaled<T> ScaledOf(const TaperedRodProblem& problem, int first, double part) {
  const double L = problem.rod.length_m;
  const auto variable = [&](double value, int input) {
    return first < 0 ? T(value) : T(value, first + input);
  };
  const auto vector = [&](const Eigen::Vector3d& v, int input) {
    Vector3<T> out;
    for (int i = 0; i < 3; ++i) out[i] = variable(v[i], input + i);
    return out;
  };
  const T force = exp(variable(std::log(problem.rod.bending_stiffness_Nm2), kStiffness)) / T(L * L);
  Scaled<T> scaled;
  scaled.span = (vector(problem.rod.p_port, kPort) - vector(problem.rod.p_wrist, kWrist)) / T(L);
  scaled.f = vector(problem.rod.f_tip, kForce) * (T(part) / force);
  scaled.q = problem.rod.q_weight.cast<T>() * (T(part * L) / force);
  scaled.y_wrist = problem.y_wrist.cast<T>();
  scaled.taper = variable(problem.rod.stiffness_taper, kTaper);
  return scaled;
}

using Unknowns = TaperedRodSolver::Unknowns;

template <class T>
void ShootFrom(const Scaled<T>& scaled, const Unknowns& x, std::span<const double> places,
               Shot<T>& shot) {
  const Eigen::Matrix<double, 3, 2> basis = NormalBasis(x.t_wrist);
  Vector3<T> t =
      x.t_wrist.cast<T>() + basis.col(0).cast<T>() * T(0, 0) + basis.col(1).cast<T>() * T(0, 1);
  t /= sqrt(t.squaredNorm());
  Vector3<T> r;
  for (int i = 0; i < 3; ++i) r[i] = T(x.r[i], 3 + i);
  shot.Shoot(scaled, t, T(x.s_port, 2), r, places);
}

/// The number of iterations it took; 0 where it did not converge.
int Newton(const Scaled<ceres::Jet<double, kUnknowns>>& scaled, Unknowns& x) {
  Shot<ceres::Jet<double, kUnknowns>> shot;
  for (int i = 1; i <= kMaxNewton; ++i) {
    ShootFrom(scaled, x, {}, shot);
    Eigen::Matrix<double, kUnknowns, 1> residual;
    Eigen::Matrix<double, kUnknowns, kUnknowns> A;
    for (int k = 0; k < kUnknowns; ++k) {
      residual[k] = shot.residual[k].a;
      A.row(k) = shot.residual[k].v.transpose();
    }
    if (!residual.allFinite()) return 0;
    if (residual.norm() < kConverged) return i;
    Eigen::Matrix<double, kUnknowns, 1> dx = -Lu(A).Solve(residual);
    if (!dx.allFinite()) return 0;
    const double turn = dx.head<2>().norm();
    if (turn > kMostTurn) dx *= kMostTurn / turn;
    x.t_wrist = (x.t_wrist + NormalBasis(x.t_wrist) * dx.head<2>()).normalized();
    x.s_port += dx[2];
    x.r += dx.tail<3>();
    if (!(x.s_port > kLeastStretch && x.s_port < 1 - kLeastStretch)) return 0;
  }
  return 0;
}

Unknowns StraightGuess(const TaperedRodProblem& problem, double part) {
  const auto scaled = ScaledOf<ceres::Jet<double, 1>>(problem, -1, part);
  Eigen::Vector3d span, load;
  for (int i = 0; i < 3; ++i) {
    span[i] = scaled.span[i].a;
    load[i] = scaled.f[i].a + 0.5 * scaled.q[i].a;
  }
  const double d = span.norm();
  const Eigen::Vector3d t = span / d;
  return {t, d, -(load - load.dot(t) * t) / d};
}

using Full = ceres::Jet<double, kUnknowns + kCount>;

/// In SI; `dx` is the unknowns' derivative by the inputs.
TaperedRodSection SectionOf(const TaperedRodProblem& problem, const State<Full>& state,
                            const Eigen::Matrix<double, kUnknowns, kCount>& dx) {
  const double L = problem.rod.length_m, unit = problem.rod.bending_stiffness_Nm2 / L;
  TaperedRodSection s;
  const auto take = [&](int first, double scale, Eigen::Vector3d& v, TaperedDerivative& d) {
    for (int i = 0; i < 3; ++i) {
      const Full& x = state[first + i];
      v[i] = scale * x.a;
      d.row(i) = scale * (x.v.tail<kCount>().transpose() + x.v.head<kUnknowns>().transpose() * dx);
    }
  };
  take(0, L, s.p, s.dp);
  take(3, 1.0, s.t, s.dt);
  take(6, 1.0, s.y, s.dy);
  take(9, unit, s.m, s.dm);
  s.p += problem.rod.p_wrist;
  s.dp.middleCols<3>(kWrist) += Eigen::Matrix3d::Identity();
  s.dm.col(kStiffness) += s.m;
  return s;
}

bool IsPlausible(const TaperedRodProblem& p) {
  const RodProblem& rod = p.rod;
  const double reach = (rod.p_port - rod.p_wrist).norm() / rod.length_m;
  return rod.length_m > 0 && rod.bending_stiffness_Nm2 > 0 && std::abs(rod.stiffness_taper) < 2 &&
         reach > kLeastStretch && reach < 1 - kLeastStretch && rod.f_tip.allFinite() &&
         rod.q_weight.allFinite() &&
         p.y_wrist.cross(rod.p_port - rod.p_wrist).norm() > 1e-6 * rod.length_m * reach;
}

}  // namespace

TaperedRodState TaperedRodSolver::Solve(const TaperedRodProblem& problem,
                                        std::span<const double> stations_m) {
  using Small = ceres::Jet<double, kUnknowns>;
  TaperedRodState state;
  if (!IsPlausible(problem)) return state;
  Unknowns x = x_;
  warm_ = warm_ && Newton(ScaledOf<Small>(problem, -1, 1.0), x) > 0;
  if (!warm_) {
    const double L = problem.rod.length_m;
    const double load = (problem.rod.f_tip.norm() + problem.rod.q_weight.norm() * L) * L * L /
                        problem.rod.bending_stiffness_Nm2;
    warm_ = InLoadSteps(
                load, kMaxNewton, x, [&](double part) { return StraightGuess(problem, part); },
                [&](double part, Unknowns& at) {
                  return Newton(ScaledOf<Small>(problem, -1, part), at);
                }) > 0;
  }
  if (!warm_) return state;
  x_ = x;
  std::vector<double> places;
  for (const double s_m : stations_m) places.push_back(s_m / problem.rod.length_m);
  Shot<Full> shot;
  ShootFrom(ScaledOf<Full>(problem, kUnknowns, 1.0), x, places, shot);
  Eigen::Matrix<double, kUnknowns, kUnknowns> A;
  Eigen::Matrix<double, kUnknowns, kCount> B;
  for (int k = 0; k < kUnknowns; ++k) {
    A.row(k) = shot.residual[k].v.head<kUnknowns>().transpose();
    B.row(k) = shot.residual[k].v.tail<kCount>().transpose();
  }
  const Eigen::Matrix<double, kUnknowns, kCount> dx = -Lu(A).Solve(B);
  state.usable = dx.allFinite();
  state.s_port_m = x.s_port * problem.rod.length_m;
  state.wrist = SectionOf(problem, shot.wrist, dx);
  state.tip = SectionOf(problem, shot.tip, dx);
  for (const auto& station : shot.stations) {
    state.stations.push_back(SectionOf(problem, station, dx));
  }
  return state;
}

}  // namespace flextip
