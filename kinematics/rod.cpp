#include "kinematics/rod.h"

#include <cmath>

#include "core/check.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "kinematics/load_steps.h"
#include "kinematics/rod_flow.h"

namespace flextip {
namespace {

constexpr double kConverged = 1e-12;   // of the scaled conditions
constexpr double kNearlyThere = 1e-9;  // from here one linear correction reaches rounding error
constexpr double kMaxLinear = 1e-6;    // largest change of the unknowns such a correction may make
constexpr int kMaxNewton = 20;
constexpr double kMaxTurn = 0.4;      // of the tip tangent in one Newton step (rad)
constexpr double kMinStretch = 1e-6;  // shortest stretch on either side of the port, of the length

// Columns of the derivatives: the unknowns (two turns of the tip tangent, the port's place, the
// port's force), then the tip force.
constexpr int kTurn = 0, kPlace = 2, kReaction = 3, kForce = 6;
using Derivative = RodFlow<9>::Derivative;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

}  // namespace

/// The problem in units of L, EI/L^2 and EI/L.
struct RodSolver::Scaled {
  Eigen::Vector3d span = Eigen::Vector3d::Zero();  // port - wrist
  Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Eigen::Vector3d q = Eigen::Vector3d::Zero();

  explicit Scaled(const RodProblem& problem)
      : span((problem.p_port - problem.p_wrist) / problem.length_m),
        f(problem.f_tip * (problem.length_m * problem.length_m / problem.bending_stiffness_Nm2)),
        q(problem.q_weight * (std::pow(problem.length_m, 3) / problem.bending_stiffness_Nm2)) {}
  Scaled WithLoad(double part) const {
    Scaled scaled = *this;
    scaled.f *= part;
    scaled.q *= part;
    return scaled;
  }
};

/// The whole rod for given unknowns: states at port and wrist, and the residual of the conditions
/// (port - wrist, no moment at the wrist, no force along the shaft at the port).
struct RodSolver::Evaluation {
  RodFlow<9> port, wrist;
  Eigen::Matrix<double, 3, 2> turn_basis;
  Vector6 residual;
  Eigen::Matrix<double, 6, 9> derivative;
  bool ok = false;

  void Correct(const Vector6& dx);
};

namespace {

/// The stretch between tip and port depends on the turns and the force only: five columns.
bool AdvanceTipStretch(const Eigen::Vector3d& t_tip, const Eigen::Matrix<double, 3, 2>& basis,
                       const Eigen::Vector3d& f, const Eigen::Vector3d& q, double length,
                       RodFlow<9>& flow) {
  RodFlow<5> tip;
  tip.t = t_tip;
  tip.dt.leftCols<2>() = basis;
  RodForce<5> force;
  force.n0 = f;
  force.q = q;
  force.dn0.rightCols<3>().setIdentity();
  if (!Advance<5>(length, force, tip)) return false;
  flow = RodFlow<9>();
  flow.t = tip.t;
  flow.m = tip.m;
  flow.P = tip.P;
  const auto widen = [](const RodFlow<5>::Derivative& from, Derivative& to) {
    to.middleCols<2>(kTurn) = from.leftCols<2>();
    to.middleCols<3>(kForce) = from.rightCols<3>();
  };
  widen(tip.dt, flow.dt);
  widen(tip.dm, flow.dm);
  widen(tip.dP, flow.dP);
  return true;
}

/// Carries `flow` from the port by `length` towards the wrist. Moving the port along the shaft
/// moves the jump of the internal force, which shows as an initial change of the moment's
/// derivative.
bool AdvanceWristStretch(const Eigen::Vector3d& n_beyond, const Eigen::Vector3d& r,
                         const Eigen::Vector3d& q, double length, RodFlow<9>& flow) {
  RodForce<9> force;
  force.n0 = n_beyond + r;
  force.q = q;
  force.dn0.middleCols<3>(kReaction).setIdentity();
  force.dn0.middleCols<3>(kForce).setIdentity();
  flow.dm.col(kPlace) -= flow.t.cross(r);
  return Advance<9>(length, force, flow);
}

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

RodSolver::Unknowns RodSolver::StraightGuess(const Scaled& scaled) {
  const double d = scaled.span.norm();
  const Eigen::Vector3d t = scaled.span / d;
  const Eigen::Vector3d lever = scaled.f + 0.5 * scaled.q;
  return {t, 1.0 - d, -(lever - lever.dot(t) * t) / d};
}

void RodSolver::Evaluate(const Scaled& scaled, const Unknowns& x, Evaluation& e) {
  e.ok = false;
  e.turn_basis = NormalBasis(x.t_tip);
  if (!AdvanceTipStretch(x.t_tip, e.turn_basis, scaled.f, scaled.q, x.sigma_port, e.port)) return;
  e.wrist = e.port;
  const Eigen::Vector3d n_beyond = scaled.f + x.sigma_port * scaled.q;
  if (!AdvanceWristStretch(n_beyond, x.r, scaled.q, 1.0 - x.sigma_port, e.wrist)) return;

  e.residual.head<3>() = e.wrist.P - e.port.P - scaled.span;
  e.derivative.topRows<3>() = e.wrist.dP - e.port.dP;
  e.derivative.block<3, 1>(0, kPlace) -= e.port.t;

  const Eigen::Matrix<double, 3, 2> across = NormalBasis(e.wrist.t);
  e.residual.segment<2>(3) = across.transpose() * e.wrist.m;
  e.derivative.middleRows<2>(3) = across.transpose() * e.wrist.dm;

  e.residual[5] = x.r.dot(e.port.t);
  e.derivative.row(5) = x.r.transpose() * e.port.dt;
  e.derivative(5, kPlace) += x.r.dot(e.port.t.cross(e.port.m));
  e.derivative.block<1, 3>(5, kReaction) += e.port.t.transpose();
  e.ok = e.residual.allFinite() && e.derivative.allFinite();
}

/// Moves the states with the unknowns to first order. The rest is of the order of the squared
/// correction, below rounding where the residual is below kNearlyThere.
void RodSolver::Evaluation::Correct(const Vector6& dx) {
  for (RodFlow<9>* flow : {&port, &wrist}) {
    const Eigen::Vector3d dt_dsigma = flow == &port
                                          ? Eigen::Vector3d(flow->t.cross(flow->m) * dx[kPlace])
                                          : Eigen::Vector3d::Zero();
    flow->t = (flow->t + flow->dt.leftCols<6>() * dx + dt_dsigma).normalized();
    flow->m += flow->dm.leftCols<6>() * dx;
    flow->P += flow->dP.leftCols<6>() * dx;
  }
  residual += derivative.leftCols<6>() * dx;
}

void RodSolver::Unknowns::Move(const Eigen::Matrix<double, 3, 2>& turn_basis, const Vector6& dx) {
  t_tip = (t_tip + turn_basis * dx.head<2>()).normalized();
  sigma_port += dx[kPlace];
  r += dx.tail<3>();
}

int RodSolver::Newton(const Scaled& scaled, Unknowns& x, Evaluation& e) {
  double last = 1e300;
  for (int i = 1; i <= kMaxNewton; ++i) {
    Evaluate(scaled, x, e);
    if (!e.ok) return 0;
    const double size = e.residual.norm();
    if (size < kConverged) return i;
    if (i > 4 && size > 0.9 * last) return 0;  // it should converge quadratically by now
    last = size;
    Vector6 dx = -Lu(e.derivative.leftCols<6>()).Solve(e.residual);
    if (!dx.allFinite()) return 0;
    const double turn = dx.head<2>().norm();
    if (turn > kMaxTurn) dx *= kMaxTurn / turn;
    // The port stays on the shaft: at most half of the way to either end in one step.
    const double room = 0.5 * (dx[kPlace] > 0 ? 1.0 - x.sigma_port : x.sigma_port);
    if (std::abs(dx[kPlace]) > room) dx *= room / std::abs(dx[kPlace]);
    x.Move(e.turn_basis, dx);
    if (x.sigma_port < kMinStretch || x.sigma_port > 1.0 - kMinStretch) return 0;
    if (size < kNearlyThere && dx.norm() < kMaxLinear) {
      e.Correct(dx);
      return i;
    }
  }
  return 0;
}

int RodSolver::SolveCold(const Scaled& scaled, Unknowns& x, Evaluation& e) {
  return InLoadSteps(
      scaled.f.norm() + scaled.q.norm(), kMaxNewton, x,
      [&](double part) { return StraightGuess(scaled.WithLoad(part)); },
      [&](double part, Unknowns& at) { return Newton(scaled.WithLoad(part), at, e); });
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
  if (state.iterations == 0) state.iterations = SolveCold(scaled, x, e);
  state.status = state.iterations > 0 ? RodStatus::kOk : RodStatus::kNotConverged;
  warm_ = state.IsUsable();
  if (!warm_) return state;
  Keep(problem, x, e);
  FillState(e, state);
  return state;
}

int RodSolver::SolveWarm(const RodProblem& problem, const Scaled& scaled, Unknowns& x,
                         Evaluation& e) const {
  if (!warm_) return 0;
  Eigen::Matrix<double, 9, 1> moved;
  moved << problem.p_wrist - problem_.p_wrist, problem.p_port - problem_.p_port,
      problem.f_tip - problem_.f_tip;
  const Vector6 dx = dx_ * moved;
  x = x_;
  // A prediction to first order, where the step is small enough for it to mean something.
  if (dx.head<2>().norm() < kMaxTurn && x.sigma_port + dx[kPlace] > kMinStretch &&
      x.sigma_port + dx[kPlace] < 1.0 - kMinStretch) {
    x.Move(turn_basis_, dx);
  }
  const int used = Newton(scaled, x, e);
  // Far from where it started, Newton may have found another branch.
  const bool near = (x.t_tip - x_.t_tip).norm() < 2 * kMaxTurn;
  return near ? used : 0;
}

void RodSolver::Keep(const RodProblem& problem, const Unknowns& x, const Evaluation& e) {
  problem_ = problem;
  x_ = x;
  turn_basis_ = e.turn_basis;
  // Implicit function theorem: A dx = -dR, R depending on port - wrist and on the force.
  const double L = problem.length_m;
  Eigen::Matrix<double, 6, 9> dR = Eigen::Matrix<double, 6, 9>::Zero();
  dR.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / L;
  dR.block<3, 3>(0, 3) = -Eigen::Matrix3d::Identity() / L;
  dR.rightCols<3>() = e.derivative.rightCols<3>() * (L * L / problem.bending_stiffness_Nm2);
  dx_ = -Lu(e.derivative.leftCols<6>()).Solve(dR);
}

RodSection RodSolver::MakeSection(const RodFlow<9>& flow, const RodSection* tip, double s_m) const {
  const double L = problem_.length_m, EI = problem_.bending_stiffness_Nm2;
  const auto total = [&](const Derivative& d) {
    RodDerivative out = d.leftCols<6>() * dx_;
    out.rightCols<3>() += d.rightCols<3>() * (L * L / EI);
    return out;
  };
  RodSection section;
  section.s_m = s_m;
  section.t = flow.t;
  section.m = flow.m * (EI / L);
  section.dt = total(flow.dt);
  section.dm = total(flow.dm) * (EI / L);
  if (tip != nullptr) {
    section.p = tip->p - L * flow.P;
    section.dp = tip->dp - L * total(flow.dP);
  } else {  // the wrist itself fixes the place of all others
    section.p = problem_.p_wrist + L * flow.P;
    section.dp = L * total(flow.dP);
    section.dp.leftCols<3>() += Eigen::Matrix3d::Identity();
  }
  return section;
}

void RodSolver::FillState(const Evaluation& e, RodState& state) {
  const double L = problem_.length_m, unit = problem_.bending_stiffness_Nm2 / (L * L);
  RodFlow<9> tip;
  tip.t = x_.t_tip;
  tip.dt.middleCols<2>(kTurn) = turn_basis_;
  tip.P = e.wrist.P;
  tip.dP = e.wrist.dP;
  state.tip = MakeSection(tip, nullptr, L);
  tip_ = state.tip;
  state.wrist = MakeSection(e.wrist, &tip_, 0.0);
  state.residual = e.residual.norm();
  state.s_port_m = (1.0 - x_.sigma_port) * L;
  state.t_port = e.port.t;
  // The port's place on the shaft moves too.
  const Eigen::Vector3d dt_dsigma = e.port.t.cross(e.port.m);
  state.dt_port = MakeSection(e.port, &tip_, state.s_port_m).dt + dt_dsigma * dx_.row(kPlace);
  state.f_port = x_.r * unit;
  state.f_wrist = -(problem_.f_tip + problem_.q_weight * L + state.f_port);
}

RodSection RodSolver::Section(double s_m) const {
  FLEXTIP_CHECK(warm_ && s_m >= 0.0 && s_m <= (1.0 + 1e-12) * problem_.length_m,
                "a place on a solved rod");
  const Scaled scaled(problem_);
  const double sigma = std::max(0.0, 1.0 - s_m / problem_.length_m);  // s_m may be rounded up
  RodFlow<9> flow;
  if (sigma == 0.0) return tip_;
  bool ok = AdvanceTipStretch(x_.t_tip, turn_basis_, scaled.f, scaled.q,
                              std::min(sigma, x_.sigma_port), flow);
  if (ok && sigma > x_.sigma_port) {
    const Eigen::Vector3d n_beyond = scaled.f + x_.sigma_port * scaled.q;
    ok = AdvanceWristStretch(n_beyond, x_.r, scaled.q, sigma - x_.sigma_port, flow);
  }
  FLEXTIP_CHECK(ok, "the path walked when the rod was solved");
  return MakeSection(flow, &tip_, s_m);
}

}  // namespace flextip
