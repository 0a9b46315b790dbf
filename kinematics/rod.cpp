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
constexpr double kMaxLinear = 1e-7;    // largest change of the unknowns such a correction may make
constexpr int kMaxNewton = 20;
constexpr double kExpected = 1e-10;   // a residual expected below this one is the last
constexpr double kNearStart = 1e-2;   // largest residual that an older derivative may correct
constexpr double kBetter = 0.03;      // by which what is learned from one step helps, at least
constexpr double kSameWay = 0.7;      // least cosine between two steps that count as going one way
constexpr double kGoodRate = 0.3;     // and the least that it has to take off each time
constexpr double kMaxTurn = 0.4;      // of the tip tangent in one Newton step (rad)
constexpr double kMinStretch = 1e-6;  // shortest stretch on either side of the port, of the length

// Columns of the derivatives: the unknowns (two turns of the tip tangent, the port's place, the
// port's force), then the tip force.
constexpr int kTurn = 0, kPlace = 2, kReaction = 3, kForce = 6;

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
  RodPlace port, wrist;
  Eigen::Vector3d n_beyond;  // internal force just beyond the port
  Vector6 residual;
  Vector6 corrected;  // change of the unknowns since the start
  Eigen::Matrix<double, 6, kRodColumns> derivative;
  Matrix6 inverse;  // of its columns for the unknowns
  bool ok = false;

  void Differentiate(const RodMap& tip_stretch, const RodMap& wrist_stretch, const Unknowns& x);
  void Learn(const Vector6& dx, const Vector6& change);
  void Correct(const Vector6& dx);
};

namespace {

/// Fills the derivatives at a place between tip and port: by the turns and the force only.
void FillTipStretch(const RodMap& map, RodPlace& place) {
  place.uv.setZero();
  place.dP.setZero();
  place.uv.middleCols<2>(kTurn) = map.flow.leftCols<2>();
  place.dP.middleCols<2>(kTurn) = map.way.leftCols<2>();
  place.uv.middleCols<3>(kForce) = map.FlowByForce();
  place.dP.middleCols<3>(kForce) = map.way_by_force;
}

/// Fills the derivatives at a place between port and wrist. Moving the port along the shaft moves
/// the jump of the internal force, which shows as an initial change of the moment.
void FillWristStretch(const RodMap& map, const RodPlace& port, const Eigen::Vector3d& r,
                      RodPlace& place) {
  Eigen::Matrix<double, 4, kRodColumns> start = port.uv;
  start.block<2, 1>(2, kPlace) += port.Across().transpose() * r;
  place.uv = map.flow * start;
  place.dP = port.dP + map.way * start;
  const Eigen::Matrix<double, 4, 3> by_force = map.FlowByForce();
  for (const int first : {kReaction, kForce}) {
    place.uv.middleCols<3>(first) += by_force;
    place.dP.middleCols<3>(first) += map.way_by_force;
  }
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
  return {t, NormalBasis(t).col(0), 1.0 - d, -(lever - lever.dot(t) * t) / d};
}

void RodSolver::Evaluate(const Scaled& scaled, const Unknowns& x, bool with_derivatives,
                         Evaluation& e) {
  RodMap tip_stretch, wrist_stretch;
  e.ok = false;
  RodPoint point{x.t_tip, x.y_tip};
  if (!Advance(x.sigma_port, {scaled.f, scaled.q}, point,
               with_derivatives ? &tip_stretch : nullptr)) {
    return;
  }
  static_cast<RodPoint&>(e.port) = point;
  e.n_beyond = scaled.f + x.sigma_port * scaled.q;
  if (!Advance(1.0 - x.sigma_port, {e.n_beyond + x.r, scaled.q}, point,
               with_derivatives ? &wrist_stretch : nullptr)) {
    return;
  }
  static_cast<RodPoint&>(e.wrist) = point;
  e.residual.head<3>() = e.wrist.P - e.port.P - scaled.span;
  e.residual.segment<2>(3) = e.wrist.Across().transpose() * e.wrist.m;
  e.residual[5] = x.r.dot(e.port.t);
  e.ok = e.residual.allFinite();
  if (!e.ok || !with_derivatives) return;
  e.Differentiate(tip_stretch, wrist_stretch, x);
  e.ok = e.derivative.allFinite();
}

/// Fills `derivative` and `inverse`.
void RodSolver::Evaluation::Differentiate(const RodMap& tip_stretch, const RodMap& wrist_stretch,
                                          const Unknowns& x) {
  FillTipStretch(tip_stretch, port);
  FillWristStretch(wrist_stretch, port, x.r, wrist);
  derivative.topRows<3>() = wrist.dP - port.dP;
  derivative.block<3, 1>(0, kPlace) -= port.t;
  derivative.row(3) = wrist.uv.row(3);
  derivative.row(4) = -wrist.uv.row(2);
  derivative.row(5) = (x.r.transpose() * port.Across()) * port.uv.topRows<2>();
  derivative(5, kPlace) += x.r.dot(port.t.cross(port.m));
  derivative.block<1, 3>(5, kReaction) += port.t.transpose();
  inverse = Lu(derivative.leftCols<6>()).Inverse();
}

/// Changes the inverse by as little as makes it right along the last step (Broyden).
void RodSolver::Evaluation::Learn(const Vector6& dx, const Vector6& change) {
  const Vector6 seen = inverse * change;
  const double size = dx.dot(seen);
  if (!(std::abs(size) > 0.1 * dx.squaredNorm())) return;
  inverse += ((dx - seen) / size) * (dx.transpose() * inverse).eval();
}

/// Moves the states with the unknowns to first order. The rest is of the order of the squared
/// correction, below rounding where the residual is below kNearlyThere.
void RodSolver::Evaluation::Correct(const Vector6& dx) {
  for (RodPlace* place : {&port, &wrist}) {
    const Eigen::Matrix<double, 4, 1> uv = place->uv.leftCols<6>() * dx;
    // The port's place moves along the shaft as well.
    const double along = place == &port ? dx[kPlace] : 0.0;
    const Eigen::Vector3d t = place->t, m = place->m;
    place->t += place->Across() * uv.head<2>() + along * t.cross(m);
    place->m += RodPoint{t, place->y, m}.MomentChange<1>(uv) + along * t.cross(n_beyond);
    place->P += place->dP.leftCols<6>() * dx + along * t;
    place->MakeOrthonormal();
  }
  residual += derivative.leftCols<6>() * dx;
}

void RodSolver::Unknowns::Move(const Vector6& dx) {
  RodPoint tip{t_tip, y_tip};
  tip.t += tip.Across() * dx.head<2>();
  tip.MakeOrthonormal();
  t_tip = tip.t;
  y_tip = tip.y;
  sigma_port += dx[kPlace];
  r += dx.tail<3>();
}

int RodSolver::Newton(const Scaled& scaled, const Start& start, Unknowns& x, Evaluation& e) {
  // The derivatives cost several walks without. So an older inverse takes the residual down as far
  // as it does well, and they come when the residual is expected to be small.
  bool near = start.near;
  double last = 1e300, expected = start.same ? 0.0 : 1.0, rate = 0.0;
  Vector6 dx = Vector6::Zero(), last_residual = Vector6::Zero();
  e.corrected.setZero();
  for (int i = 1; i <= kMaxNewton; ++i) {
    // Not where four walks would not do. (The rate itself gets better.)
    const double fourth = i == 2 ? rate * rate * kBetter : i == 3 ? rate : 1.0;
    const bool full = !near || expected < kExpected || (i > 1 && fourth * expected > kExpected);
    Evaluate(scaled, x, full, e);
    if (!e.ok) return 0;
    const double size = e.residual.norm();
    if (full && size < kConverged) return i;
    if (!full && size > (i == 1 ? kNearStart : kGoodRate * last)) {
      near = false;  // it no longer does well
      continue;
    }
    if (full && i > 4 && size > 0.9 * last) return 0;  // it should converge quadratically by now
    if (!full) {
      if (i > 1) e.Learn(dx, e.residual - last_residual);
      rate = i > 1 ? size / last : start.rate > 0 ? start.rate : 2.0 * size / start.moved;
      expected = rate * size;
    }
    last = size;
    last_residual = e.residual;
    dx = -(e.inverse * e.residual);
    if (!dx.allFinite()) return 0;
    const double turn = dx.head<2>().norm();
    if (turn > kMaxTurn) dx *= kMaxTurn / turn;
    // The port stays on the shaft: at most half of the way to either end in one step.
    const double room = 0.5 * (dx[kPlace] > 0 ? 1.0 - x.sigma_port : x.sigma_port);
    if (std::abs(dx[kPlace]) > room) dx *= room / std::abs(dx[kPlace]);
    e.corrected += dx;
    const bool done = full && size < kNearlyThere && dx.norm() < kMaxLinear;
    if (done) e.Correct(dx);
    x.Move(dx);
    if (x.sigma_port < kMinStretch || x.sigma_port > 1.0 - kMinStretch) return 0;
    if (done) return i;
  }
  return 0;
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
  start.same = start.moved == 0.0 && moved.isZero(0.0);
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
