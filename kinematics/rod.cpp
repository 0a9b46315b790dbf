#include "kinematics/rod.h"

#include <cmath>

#include "core/check.h"
#include "core/rotation.h"
#include "kinematics/load_steps.h"
#include "kinematics/rod/conditions.h"

namespace flextip {
namespace {

constexpr double kSameWay = 0.7;  // least cosine between two steps that count as going one way

bool IsFinite(const RodProblem& p) {
  return std::isfinite(p.length_m) && std::isfinite(p.bending_stiffness_Nm2) &&
         p.p_wrist.allFinite() && p.p_port.allFinite() && p.f_tip.allFinite() &&
         p.q_weight.allFinite();
}

}  // namespace

const char* Name(RodStatus status) {
  switch (status) {
    case RodStatus::kOk:
      return "ok";
    case RodStatus::kBadInput:
      return "bad_input";
    case RodStatus::kUnreachable:
      return "unreachable";
    case RodStatus::kNotConverged:
      return "not_converged";
  }
  return "";
}

Eigen::Matrix3d RodState::J_tip_wrist(const Eigen::Matrix3d& stiffness) const {
  // dp = J dw + C df with df = K dp.
  const Eigen::Matrix3d C = tip.dp.rightCols<3>();
  return (Eigen::Matrix3d::Identity() - C * stiffness).inverse() * tip.dp.leftCols<3>();
}

void VisitState(RodProblem& problem, StateText& state) {
  state(problem.length_m);
  state(problem.bending_stiffness_Nm2);
  state(problem.p_wrist);
  state(problem.p_port);
  state(problem.f_tip);
  state(problem.q_weight);
  state(problem.stiffness_taper);
}

RodSolver::Unknowns RodSolver::StraightGuess(const Scaled& scaled) {
  const double d = scaled.span.norm();
  const Eigen::Vector3d t = scaled.span / d;
  const Eigen::Vector3d lever = scaled.f + 0.5 * scaled.q;
  return {t, NormalBasis(t).col(0), 1.0 - d, -(lever - lever.dot(t) * t) / d};
}

int RodSolver::SolveCold(const Scaled& scaled, Unknowns& x, Evaluation& e) {
  return InLoadSteps(
      scaled.f.norm() + scaled.q.norm(), kMaxNewton, x,
      [&](double part) { return StraightGuess(scaled.WithLoad(part)); },
      [&](double part, Unknowns& at) { return Newton(scaled.WithLoad(part), {}, at, e); });
}

RodState RodSolver::Solve(const RodProblem& problem) {
  RodState state;
  state.status = RodStatus::kBadInput;
  if (!IsFinite(problem) || problem.length_m <= 0 || problem.bending_stiffness_Nm2 <= 0 ||
      problem.stiffness_taper != 0)
    return state;
  const Scaled scaled(problem);
  const double reach = scaled.span.norm();
  state.status = RodStatus::kUnreachable;
  if (reach < kMinStretch || reach > 1.0 - kMinStretch) return state;

  Unknowns x;
  Evaluation e;
  state.iterations = SolveWarm(problem, scaled, x, e);
  if (state.iterations == 0) {
    predicted_.setZero();
    missed_.setZero();
    state.iterations = SolveCold(scaled, x, e);
  }
  state.status = state.iterations > 0 ? RodStatus::kOk : RodStatus::kNotConverged;
  warm_ = state.IsUsable();
  if (!warm_) return state;
  Keep(problem, x, e);
  FillState(e, state);
  return state;
}

void RodSolver::VisitState(StateText& state) {
  state(warm_);
  state(predicted_);
  state(missed_);
  if (!warm_) return;
  flextip::VisitState(problem_, state);
  state(x_.t_tip);
  state(x_.y_tip);
  state(x_.sigma_port);
  state(x_.r);
  state(inverse_);
  state(dx_);
}

int RodSolver::SolveWarm(const RodProblem& problem, const Scaled& scaled, Unknowns& x,
                         Evaluation& e) {
  if (!warm_) return 0;
  Eigen::Matrix<double, 9, 1> moved;
  moved << problem.p_wrist - problem_.p_wrist, problem.p_port - problem_.p_port,
      problem.f_tip - problem_.f_tip;
  // A prediction to first order, and to second where the last step went the same way.
  Vector6 dx = dx_ * moved, first = dx;
  Start start;
  start.moved = dx.norm();
  start.same = start.moved == 0.0;  // as where wrist and port move together
  const double last = predicted_.norm(), along = dx.dot(predicted_);
  if (along > kSameWay * last * start.moved) {
    const double part = along / (last * last);
    dx += part * part * missed_;
    start.rate = 2.0 * missed_.norm() * start.moved / (last * last);
  }
  x = x_;
  // Only where the step is small enough for a prediction to mean something.
  if (dx.head<2>().norm() < kMaxTurn && x.sigma_port + dx[kPlace] > kMinStretch &&
      x.sigma_port + dx[kPlace] < 1.0 - kMinStretch) {
    x.Move(dx);
    e.inverse = inverse_;
    start.near = true;
  } else {
    dx.setZero();
  }
  const int used = Newton(scaled, start, x, e);
  // Far from where it started, Newton may have found another branch.
  const bool near = (x.t_tip - x_.t_tip).norm() < 2 * kMaxTurn;
  predicted_ = first;
  missed_ = dx + e.corrected - first;
  return near ? used : 0;
}

void RodSolver::Keep(const RodProblem& problem, const Unknowns& x, const Evaluation& e) {
  problem_ = problem;
  x_ = x;
  port_ = e.port;
  inverse_ = e.inverse;
  // Implicit function theorem: A dx = -dR, R depending on port - wrist and on the force.
  const double L = problem.length_m;
  dx_.leftCols<3>() = -inverse_.leftCols<3>() / L;
  dx_.middleCols<3>(3) = -dx_.leftCols<3>();
  dx_.rightCols<3>() =
      -(inverse_ * e.derivative.rightCols<3>()) * (L * L / problem.bending_stiffness_Nm2);
}

template <int R>
Eigen::Matrix<double, R, 9> RodSolver::Total(const Eigen::Matrix<double, R, 9>& by_columns) const {
  const double unit = problem_.bending_stiffness_Nm2 / (problem_.length_m * problem_.length_m);
  Eigen::Matrix<double, R, 9> total = by_columns.template leftCols<6>() * dx_;
  total.template rightCols<3>() += by_columns.template rightCols<3>() / unit;
  return total;
}

RodSection RodSolver::MakeSection(const RodPlace& place, double s_m) const {
  const double L = problem_.length_m, EI = problem_.bending_stiffness_Nm2;
  const Eigen::Matrix<double, 4, 9> uv = Total<4>(place.uv);
  RodSection section;
  section.s_m = s_m;
  section.t = place.t;
  section.m = place.m * (EI / L);
  section.dt = place.Across() * uv.topRows<2>();
  section.dm = place.MomentChange<9>(uv) * (EI / L);
  section.p = tip_.p - L * place.P;
  section.dp = tip_.dp - L * Total<3>(place.dP);
  return section;
}

void RodSolver::FillState(const Evaluation& e, RodState& state) {
  const double L = problem_.length_m, EI = problem_.bending_stiffness_Nm2;
  // The wrist's place is given, and it bears no moment.
  tip_ = RodSection();
  tip_.s_m = L;
  tip_.t = x_.t_tip;
  tip_.dt = RodPoint{x_.t_tip, x_.y_tip}.Across() * dx_.middleRows<2>(kTurn);
  tip_.p = problem_.p_wrist + L * e.wrist.P;
  tip_.dp = L * Total<3>(e.wrist.dP);
  tip_.dp.leftCols<3>() += Eigen::Matrix3d::Identity();
  state.tip = tip_;
  state.wrist.p = problem_.p_wrist;
  state.wrist.dp.leftCols<3>().setIdentity();
  state.wrist.t = e.wrist.t;
  state.wrist.dt = e.wrist.Across() * Total<2>(e.wrist.uv.topRows<2>());
  state.wrist.m = e.wrist.m * (EI / L);
  state.residual = e.residual.norm();
  state.s_port_m = (1.0 - x_.sigma_port) * L;
  state.t_port = e.port.t;
  // The port's place on the shaft moves too.
  state.dt_port = e.port.Across() * Total<2>(e.port.uv.topRows<2>());
  state.dt_port += e.port.t.cross(e.port.m) * dx_.row(kPlace);
  state.f_port = x_.r * (EI / (L * L));
  state.f_wrist = -(problem_.f_tip + problem_.q_weight * L + state.f_port);
}

RodSection RodSolver::Section(double s_m) const {
  FLEXTIP_CHECK(warm_ && s_m >= 0.0 && s_m <= (1.0 + 1e-12) * problem_.length_m,
                "a place on a solved rod");
  const Scaled scaled(problem_);
  const double sigma = std::max(0.0, 1.0 - s_m / problem_.length_m);  // s_m may be rounded up
  if (sigma == 0.0) return tip_;
  RodPlace place;
  RodMap map;
  bool ok = true;
  if (sigma <= x_.sigma_port) {
    place.t = x_.t_tip;
    place.y = x_.y_tip;
    ok = Advance(sigma, {scaled.f, scaled.q}, place, &map);
    FillTipStretch(map, place);
  } else {
    static_cast<RodPoint&>(place) = port_;
    const Eigen::Vector3d n = scaled.f + x_.sigma_port * scaled.q + x_.r;
    ok = Advance(sigma - x_.sigma_port, {n, scaled.q}, place, &map);
    FillWristStretch(map, port_, x_.r, place);
  }
  FLEXTIP_CHECK(ok, "the path walked when the rod was solved");
  return MakeSection(place, s_m);
}

}  // namespace flextip
