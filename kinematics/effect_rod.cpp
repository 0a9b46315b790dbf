#include "kinematics/effect_rod.h"

#include <cmath>

#include "core/rotation.h"
#include "kinematics/effect_shot.h"
#include "kinematics/load_steps.h"

namespace flextip {
namespace {

using namespace effect_flow;

constexpr double kConverged = 1e-11;  // of the scaled conditions
constexpr int kMaxNewton = 20;
constexpr double kQuickFall =
    1e-3;                         // of the conditions in a step, after which derivatives still do
constexpr double kMaxTurn = 0.4;  // of the wrist tangent in one Newton step (rad)
constexpr double kMinStretch = 1e-6;  // shortest stretch on either side of the port, of the length

}  // namespace

void VisitState(RodEffects& effects, StateText& state) {
  state(effects.y_wrist);
  state(effects.curvature_1_m);
  state(effects.port_compliance_m_N);
  state(effects.wrist_compliance_m_N);
  state(effects.port_couple_Nm);
  state(effects.port_friction);
  state(effects.q_inside_N_m);
}

void EffectRodSolver::VisitState(StateText& state) {
  state(warm_);
  if (!warm_) return;
  state(x_.t_wrist);
  state(x_.torsion);
  state(x_.s_port);
  state(x_.r);
  state(y_);
  state(z_);
  state(inputs_);
  state(dx_);
}

namespace {

using UnknownsByInputs = Eigen::Matrix<double, kUnknowns, rod_input::kCount>;

bool IsPlausible(const EffectRodProblem& problem, std::span<const RodStation> stations) {
  const double L = problem.rod.length_m;
  if (!(L > 0.0 && problem.rod.bending_stiffness_Nm2 > 0.0)) return false;
  if (!(std::abs(problem.rod.stiffness_taper) < 2.0)) return false;
  if (!Inputs(problem).allFinite() || !problem.effects.y_wrist.allFinite()) return false;
  if (stations.size() > kMaxRodStations) return false;
  for (const RodStation& station : stations) {
    if (!(station.s_m > 0.0 && station.s_m < L)) return false;
  }
  return problem.effects.y_wrist.norm() > 0.0;
}

/// Returns the straight shaft, with the port's force that the lever asks for.
EffectRodUnknowns StraightGuess(const ScaledProblem& problem) {
  const double d = problem.span().norm();
  const Eigen::Vector3d t = problem.span() / d;
  const Eigen::Vector3d lever =
      problem.f() + 0.5 * problem.q() + 0.5 * (1.0 - d * d) * problem.inside();
  return {t, 0.0, d, -(lever - lever.dot(t) * t) / d};
}

void Move(const Eigen::Vector3d& y, const Eigen::Vector3d& z, const UnknownVector& dx,
          EffectRodUnknowns& x) {
  x.t_wrist = (x.t_wrist + dx[kTurn] * y + dx[kTurn + 1] * z).normalized();
  x.torsion += dx[kTorsion];
  x.s_port += dx[kPlace];
  x.r += dx.segment<3>(kReaction);
}

bool OnShaft(double s_port) { return s_port > kMinStretch && s_port < 1.0 - kMinStretch; }

/// Returns the number of evaluations; 0 where the iteration did not converge.
int Newton(const ScaledProblem& problem, EffectRodUnknowns& x, EffectShot& shot) {
  double last = 1e300;
  // Of seven unknowns: Eigen's own, which allocates nothing (core/linear_algebra.h has no 7).
  Eigen::PartialPivLU<decltype(shot.A)> lu;
  for (int i = 1; i <= kMaxNewton; ++i) {
    if (!shot.Shoot(problem, x)) return 0;
    const double size = shot.residual.norm();
    if (size < kConverged) return i;
    if (i > 4 && size > 0.9 * last) return 0;  // it should converge quadratically by now
    if (i == 1 || size > kQuickFall * last) {
      if (!shot.Linearize(problem, x)) return 0;
      lu.compute(shot.A);
    }
    last = size;
    UnknownVector dx = -lu.solve(shot.residual);
    if (!dx.allFinite()) return 0;
    const double turn = dx.segment<2>(kTurn).norm();
    if (turn > kMaxTurn) dx *= kMaxTurn / turn;
    // The port stays on the shaft: at most half of the way to either end in one step.
    const double room = 0.5 * (dx[kPlace] > 0 ? 1.0 - x.s_port : x.s_port);
    if (std::abs(dx[kPlace]) > room) dx *= room / std::abs(dx[kPlace]);
    Move(shot.wrist.y, shot.wrist.z, dx, x);
    if (!OnShaft(x.s_port)) return 0;
  }
  return 0;
}

int SolveCold(const ScaledProblem& problem, EffectRodUnknowns& x, EffectShot& shot) {
  const double load = problem.f().norm() + problem.q().norm() + problem.inside().norm() +
                      problem.curvature().norm() + problem.couple().norm();
  return InLoadSteps(
      load, kMaxNewton, x, [&](double part) { return StraightGuess(problem.WithPart(part)); },
      [&](double part, EffectRodUnknowns& at) { return Newton(problem.WithPart(part), at, shot); });
}

/// Turns the derivatives of a converged shot into those of the state, in SI.
class StateWriter {
 public:
  StateWriter(const EffectRodProblem& problem, const EffectScaling& scaling, EffectShot& shot,
              const EffectRodUnknowns& x, const UnknownsByInputs& dx);

  void Write(std::span<const RodStation> stations, std::span<const double> places,
             const FlowColumns* columns, EffectRodState& state) const;

 private:
  /// Derivatives of the turn, the scaled moment and the scaled way from the given wrist, by the
  /// inputs in SI.
  struct Total {
    InputDerivative turn, m, P;
  };
  InputDerivative Sum(const ByUnknowns& by_x, const InputDerivative& by_g) const {
    return by_x * dx_ + scaling_.ToInputs<3>(by_g);
  }
  Total BeforePort(const FlowColumns& columns) const;
  Total BeyondPort(const FlowColumns& columns) const;
  void WriteSection(const FlowState& at, const Total& total, double s_m,
                    EffectRodSection& section) const;
  void WriteStation(const RodStation& station, double place, const FlowColumns& columns,
                    EffectRodSection& section) const;
  void WritePort(EffectRodState& state) const;

  const EffectRodProblem& problem_;
  const EffectScaling& scaling_;
  const EffectShot& shot_;
  const EffectRodUnknowns& x_;
  const UnknownsByInputs& dx_;
  Total start_beyond_;  // just beyond the port, which moves along the shaft
};

StateWriter::StateWriter(const EffectRodProblem& problem, const EffectScaling& scaling,
                         EffectShot& shot, const EffectRodUnknowns& x, const UnknownsByInputs& dx)
    : problem_(problem), scaling_(scaling), shot_(shot), x_(x), dx_(dx) {
  start_beyond_.turn = Sum(shot.at_beyond.turn_x, shot.at_beyond.turn_g);
  start_beyond_.m = Sum(shot.at_beyond.m_x, shot.at_beyond.m_g);
  start_beyond_.P = Sum(shot.at_port.P_x, shot.at_port.P_g);
}

StateWriter::Total StateWriter::BeforePort(const FlowColumns& columns) const {
  const PlaceDerivative d = shot_.Before(scaling_.scaled, x_, columns, true);
  return {Sum(d.turn_x, d.turn_g), Sum(d.m_x, d.m_g), Sum(d.P_x, d.P_g)};
}

StateWriter::Total StateWriter::BeyondPort(const FlowColumns& columns) const {
  const auto total = [&](const ColumnMatrix& c) -> InputDerivative {
    InputDerivative own = InputDerivative::Zero();
    own.middleCols<3>(rod_input::kForce) = c.middleCols<3>(kBeyondForce);
    own.middleCols<3>(rod_input::kWeight) = c.middleCols<3>(kBeyondWeight);
    own.middleCols<3>(rod_input::kInside) = c.middleCols<3>(kBeyondWeight);
    own.middleCols<2>(rod_input::kCurvature) = c.middleCols<2>(kBeyondCurvature);
    return c.leftCols<3>() * start_beyond_.turn + c.middleCols<3>(3) * start_beyond_.m +
           scaling_.ToInputs<3>(own);
  };
  return {total(columns.turn), total(columns.m), start_beyond_.P + total(columns.P)};
}

void StateWriter::WriteSection(const FlowState& at, const Total& total, double s_m,
                               EffectRodSection& section) const {
  const double L = scaling_.L, unit = scaling_.EI / L;
  const Eigen::Vector3d P = scaling_.scaled.WristCompliance() * shot_.n_wrist + at.P;
  section.s_m = s_m;
  section.p = problem_.rod.p_wrist + L * P;
  section.t = at.t;
  section.y = at.y;
  section.m = unit * at.m;
  section.dp = L * total.P;
  section.dp.middleCols<3>(rod_input::kWrist) += Eigen::Matrix3d::Identity();
  section.dp.col(rod_input::kLength) += P;
  section.dt = -Skew(at.t) * total.turn;
  section.dy = -Skew(at.y) * total.turn;
  section.dm = unit * total.m;
  section.dm.col(rod_input::kStiffness) += section.m;
  section.dm.col(rod_input::kLength) -= section.m / L;
}

/// A station keeps its distance in metres from wrist or tip when the length changes.
void StateWriter::WriteStation(const RodStation& station, double place, const FlowColumns& columns,
                               EffectRodSection& section) const {
  const bool is_before = place <= x_.s_port;
  const FlowPath& path = is_before ? shot_.before : shot_.beyond;
  const double s = is_before ? place : place - x_.s_port;
  const FlowState at = path.At(s);
  Total total = is_before ? BeforePort(columns) : BeyondPort(columns);
  const double ds_dL = ((station.from_tip ? 1.0 : 0.0) - place) / scaling_.L;
  const FlowLoad& load = path.load;
  total.turn.col(rod_input::kLength) += ds_dL * load.RateAt(s, at);
  total.m.col(rod_input::kLength) += ds_dL * (load.n0 - s * load.q).cross(at.t);
  total.P.col(rod_input::kLength) += ds_dL * at.t;
  WriteSection(at, total, place * scaling_.L, section);
}

void StateWriter::WritePort(EffectRodState& state) const {
  const double L = scaling_.L, unit = scaling_.EI / (L * L);
  state.s_port_m = x_.s_port * L;
  state.ds_port = L * dx_.row(kPlace);
  state.ds_port[rod_input::kLength] += x_.s_port;
  state.t_port = shot_.port.t;
  state.dt_port = -Skew(shot_.port.t) * Sum(shot_.port_turn_x, shot_.at_port.turn_g);
  state.f_port = unit * x_.r;
  state.df_port = unit * dx_.middleRows<3>(kReaction);
  state.df_port.col(rod_input::kStiffness) += state.f_port;
  state.df_port.col(rod_input::kLength) -= 2.0 / L * state.f_port;
  state.f_wrist = -unit * shot_.n_wrist;
}

void StateWriter::Write(std::span<const RodStation> stations, std::span<const double> places,
                        const FlowColumns* columns, EffectRodState& state) const {
  WriteSection(shot_.wrist, BeforePort(shot_.wrist_columns), 0.0, state.wrist);
  WriteSection(shot_.beyond.end, BeyondPort(shot_.tip_columns), scaling_.L, state.tip);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    WriteStation(stations[i], places[i], columns[i], state.stations[i]);
  }
  WritePort(state);
}

}  // namespace

EffectRodState EffectRodSolver::Solve(const EffectRodProblem& problem,
                                      std::span<const RodStation> stations) {
  EffectRodState state;
  state.status = RodStatus::kBadInput;
  if (!IsPlausible(problem, stations)) return state;
  const EffectScaling scaling(problem);
  const ScaledProblem& scaled = scaling.scaled;
  const double reach = scaled.span().norm();
  state.status = RodStatus::kUnreachable;
  if (reach < kMinStretch || reach > 1.0 - kMinStretch) return state;
  state.status = RodStatus::kBadInput;
  if (scaled.y_wrist.cross(scaled.span()).norm() < 1e-6 * reach) return state;

  EffectRodUnknowns x;
  EffectShot shot;
  const InputVector inputs = Inputs(problem);
  if (warm_) {
    x = x_;
    // A prediction to first order, where the step is small enough for it to mean something.
    const UnknownVector dx = dx_ * (inputs - inputs_);
    if (dx.segment<2>(kTurn).norm() < kMaxTurn && OnShaft(x.s_port + dx[kPlace])) {
      Move(y_, z_, dx, x);
    }
    state.iterations = Newton(scaled, x, shot);
    // Far from where it started, Newton may have found another branch.
    if ((x.t_wrist - x_.t_wrist).norm() >= 2 * kMaxTurn) state.iterations = 0;
  }
  if (state.iterations == 0) state.iterations = SolveCold(scaled, x, shot);
  warm_ = state.iterations > 0;
  state.status = warm_ ? RodStatus::kOk : RodStatus::kNotConverged;
  if (!warm_) return state;

  std::array<double, kMaxRodStations> places{};
  std::array<FlowColumns, kMaxRodStations> columns;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const double s = stations[i].s_m / scaling.L;
    places[i] = stations[i].from_tip ? 1.0 - s : s;
  }
  const std::span<const double> asked(places.data(), stations.size());
  shot.Differentiate(scaled, x, asked, columns.data());
  x_ = x;
  y_ = shot.wrist.y;
  z_ = shot.wrist.z;
  inputs_ = inputs;
  dx_ = -shot.A.partialPivLu().solve(scaling.ToInputs<kUnknowns>(shot.B));
  StateWriter(problem, scaling, shot, x_, dx_).Write(stations, asked, columns.data(), state);
  return state;
}

}  // namespace flextip
