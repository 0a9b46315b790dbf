#include "kinematics/effect_shot.h"

#include <cmath>

#include "core/rotation.h"

namespace flextip::effect_flow {
namespace {

/// Exponents of EI and L by which the inputs become pure numbers.
struct Exponents {
  int first, count;
  double stiffness, length;
};
constexpr std::array<Exponents, 9> kExponents{{{rod_input::kPort, 3, 0, -1},
                                               {rod_input::kForce, 3, -1, 2},
                                               {rod_input::kWeight, 3, -1, 3},
                                               {rod_input::kCurvature, 2, 0, 1},
                                               {rod_input::kPortCompliance, 1, 1, -3},
                                               {rod_input::kWristCompliance, 1, 1, -3},
                                               {rod_input::kPortCouple, 3, -1, 1},
                                               {rod_input::kPortFriction, 1, 0, 0},
                                               {rod_input::kInside, 3, -1, 3}}};

}  // namespace

InputVector Inputs(const EffectRodProblem& problem) {
  const RodProblem& rod = problem.rod;
  const RodEffects& effects = problem.effects;
  InputVector u;
  u << rod.p_wrist, rod.p_port, rod.f_tip, std::log(rod.bending_stiffness_Nm2), rod.length_m,
      rod.q_weight, effects.curvature_1_m, effects.port_compliance_m_N,
      effects.wrist_compliance_m_N, effects.port_couple_Nm, effects.port_friction,
      effects.q_inside_N_m;
  return u;
}

ScaledProblem ScaledProblem::WithPart(double part) const {
  ScaledProblem scaled = *this;
  scaled.g *= part;
  scaled.g.segment<3>(rod_input::kPort) = span();
  return scaled;
}

EffectScaling::EffectScaling(const EffectRodProblem& problem)
    : L(problem.rod.length_m), EI(problem.rod.bending_stiffness_Nm2) {
  InputVector u = Inputs(problem);
  u.segment<3>(rod_input::kPort) -= problem.rod.p_wrist;
  factor.setZero();
  by_stiffness.setZero();
  by_length.setZero();
  for (const Exponents& e : kExponents) {
    const double scale = std::pow(EI, e.stiffness) * std::pow(L, e.length);
    for (int i = e.first; i < e.first + e.count; ++i) {
      factor[i] = scale;
      scaled.g[i] = scale * u[i];
      by_stiffness[i] = e.stiffness * scaled.g[i];
      by_length[i] = e.length / L * scaled.g[i];
    }
  }
  scaled.y_wrist = problem.effects.y_wrist.normalized();
  scaled.taper = problem.rod.stiffness_taper;
}

/// The wrist's frame is made of y_wrist's part across the tangent, so that a turn of the tangent
/// also rolls it a little.
void EffectShot::StartColumns(const ScaledProblem& problem, const EffectRodUnknowns& x) {
  const double along = problem.y_wrist.dot(wrist.t);
  const double roll = along / (problem.y_wrist - along * wrist.t).norm();
  FlowColumns& c = wrist_columns;
  c = FlowColumns();
  c.turn.col(kTurn) = wrist.z;
  c.turn.col(kTurn + 1) = -wrist.y - roll * wrist.t;
  c.m.col(kTurn) = x.torsion * wrist.y;
  c.m.col(kTurn + 1) = x.torsion * wrist.z;
  c.m.col(kTorsion) = wrist.t;
  before_forcing_ = FlowForcing();
  before_forcing_.dn0.middleCols<3>(kBeforeForce).setIdentity();
  before_forcing_.dn0.middleCols<3>(kBeforeWeight).setIdentity();
  before_forcing_.dq.middleCols<3>(kBeforeWeight).setIdentity();
  before_forcing_.dcurvature.middleCols<2>(kBeforeCurvature).setIdentity();

  tip_columns = FlowColumns();
  tip_columns.turn.leftCols<3>().setIdentity();
  tip_columns.m.middleCols<3>(3).setIdentity();
  beyond_forcing_ = FlowForcing();
  beyond_forcing_.dn0.middleCols<3>(kBeyondForce).setIdentity();
  beyond_forcing_.dn0.middleCols<3>(kBeyondWeight) = (1.0 - x.s_port) * Eigen::Matrix3d::Identity();
  beyond_forcing_.dq.middleCols<3>(kBeyondWeight).setIdentity();
  beyond_forcing_.dcurvature.middleCols<2>(kBeyondCurvature).setIdentity();
}

bool EffectShot::Shoot(const ScaledProblem& problem, const EffectRodUnknowns& x) {
  wrist = FlowState();
  wrist.t = x.t_wrist;
  wrist.y = problem.y_wrist - problem.y_wrist.dot(x.t_wrist) * x.t_wrist;
  if (!(wrist.y.norm() > 1e-9)) return false;
  wrist.MakeOrthonormal();
  wrist.m = x.torsion * wrist.t;
  const Eigen::Vector3d q = problem.q(), q_beyond = q + problem.inside();
  const Eigen::Vector3d n_beyond = problem.f() + (1.0 - x.s_port) * q_beyond;
  n_wrist = n_beyond + x.r + x.s_port * q;
  if (!before.Walk(wrist, problem.LoadFrom(0.0, n_wrist, q), x.s_port)) return false;
  port = before.end;
  FlowState start = port;
  start.m -= port.t.cross(problem.couple());
  if (!beyond.Walk(start, problem.LoadFrom(x.s_port, n_beyond, q_beyond), 1.0 - x.s_port)) {
    return false;
  }
  Conditions(problem, x);
  return residual.allFinite();
}

bool EffectShot::Linearize(const ScaledProblem& problem, const EffectRodUnknowns& x) {
  StartColumns(problem, x);
  port_columns = wrist_columns;
  CarryColumns(before, before_forcing_, 0, kNewtonColumns, port_columns, {}, nullptr);
  CarryColumns(beyond, beyond_forcing_, 0, kNewtonColumns, tip_columns, {}, nullptr);
  PassPort(problem, x, false);
  ConditionsByUnknowns(problem, x);
  return A.allFinite();
}

void EffectShot::Differentiate(const ScaledProblem& problem, const EffectRodUnknowns& x,
                               std::span<const double> places, FlowColumns* at_places) {
  std::array<double, kMaxRodStations> on_before{}, on_beyond{};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool is_before = places[i] <= x.s_port;
    on_before[i] = is_before ? places[i] : -1.0;
    on_beyond[i] = is_before ? -1.0 : places[i] - x.s_port;
  }
  const std::size_t count = places.size();
  StartColumns(problem, x);
  port_columns = wrist_columns;
  CarryColumns(before, before_forcing_, 0, kBeforeEnd, port_columns, {on_before.data(), count},
               at_places);
  CarryColumns(beyond, beyond_forcing_, 0, kBeyondEnd, tip_columns, {on_beyond.data(), count},
               at_places);
  PassPort(problem, x, true);
  ConditionsByUnknowns(problem, x);

  // The residual by the scaled inputs; its order is that of Conditions().
  const Eigen::Vector3d r = x.r, lateral = r - r.dot(port.t) * port.t;
  const double along = r.dot(port.t), size = std::hypot(lateral.norm(), kMinLateral);
  const Eigen::Matrix<double, 3, rod_input::kCount> dt = -Skew(port.t) * at_port.turn_g;
  const Eigen::Matrix<double, 3, rod_input::kCount> dlateral =
      -along * dt - port.t * (r.transpose() * dt);
  B.topRows<3>() = at_port.P_g + problem.PortCompliance() * dlateral;
  B.block<3, 3>(0, rod_input::kPort) -= Eigen::Matrix3d::Identity();
  B.block<3, 1>(0, rod_input::kPortCompliance) += lateral;
  const auto tip = tip_columns.m.leftCols<6>();
  B.middleRows<3>(3) = tip.leftCols<3>() * at_beyond.turn_g + tip.rightCols<3>() * at_beyond.m_g;
  B.block<3, 3>(3, rod_input::kForce) += tip_columns.m.middleCols<3>(kBeyondForce);
  B.block<3, 3>(3, rod_input::kWeight) += tip_columns.m.middleCols<3>(kBeyondWeight);
  B.block<3, 3>(3, rod_input::kInside) += tip_columns.m.middleCols<3>(kBeyondWeight);
  B.block<3, 2>(3, rod_input::kCurvature) += tip_columns.m.middleCols<2>(kBeyondCurvature);
  B.row(6) = r.transpose() * dt;
  B.row(6) -= (problem.friction() / size) * (lateral.transpose() * dlateral);
  B(6, rod_input::kPortFriction) -= size;
}

PlaceDerivative EffectShot::Before(const ScaledProblem& problem, const EffectRodUnknowns& x,
                                   const FlowColumns& columns, bool with_inputs) const {
  PlaceDerivative d;
  const auto by_unknowns = [&](const ColumnMatrix& c, ByUnknowns& out) {
    const auto force = c.middleCols<3>(kBeforeForce);
    out.leftCols<3>() = c.leftCols<3>();
    out.col(kPlace) = -force * problem.inside();  // less of the shaft is beyond the port
    out.rightCols<3>() = force;
  };
  by_unknowns(columns.turn, d.turn_x);
  by_unknowns(columns.m, d.m_x);
  by_unknowns(columns.P, d.P_x);
  // The wrist yields by its compliance times the force on the arm.
  const double yields = problem.WristCompliance();
  d.P_x.col(kPlace) -= yields * problem.inside();
  d.P_x.rightCols<3>() += yields * Eigen::Matrix3d::Identity();
  if (!with_inputs) return d;
  const double beyond_length = 1.0 - x.s_port;
  const auto by_inputs = [&](const ColumnMatrix& c, InputDerivative& out) {
    out.setZero();
    out.middleCols<3>(rod_input::kForce) = c.middleCols<3>(kBeforeForce);
    out.middleCols<3>(rod_input::kWeight) = c.middleCols<3>(kBeforeWeight);
    out.middleCols<2>(rod_input::kCurvature) = c.middleCols<2>(kBeforeCurvature);
    out.middleCols<3>(rod_input::kInside) = beyond_length * c.middleCols<3>(kBeforeForce);
  };
  by_inputs(columns.turn, d.turn_g);
  by_inputs(columns.m, d.m_g);
  by_inputs(columns.P, d.P_g);
  const Eigen::Matrix3d I = yields * Eigen::Matrix3d::Identity();
  d.P_g.middleCols<3>(rod_input::kForce) += I;
  d.P_g.middleCols<3>(rod_input::kWeight) += I;
  d.P_g.middleCols<3>(rod_input::kInside) += beyond_length * I;
  d.P_g.col(rod_input::kWristCompliance) += n_wrist;
  return d;
}

/// Sets the start of the part beyond the port. Where the port moves along the shaft, its jumps of
/// force and moment move with it: the states beyond change by the difference of their rates.
void EffectShot::PassPort(const ScaledProblem& problem, const EffectRodUnknowns& x,
                          bool with_inputs) {
  at_port = Before(problem, x, port_columns, with_inputs);
  const Eigen::Vector3d couple = port.t.cross(problem.couple());
  port_turn_x = at_port.turn_x;
  port_turn_x.col(kPlace) += before.load.RateAt(x.s_port, port);
  // d((turn x t) x c) for the couple t x c.
  const Eigen::Matrix3d follow = Skew(problem.couple()) * Skew(port.t);
  at_beyond.turn_x = at_port.turn_x;
  at_beyond.turn_x.col(kPlace) += couple / before.load.StiffnessAt(x.s_port);
  at_beyond.m_x = at_port.m_x - follow * port_turn_x;
  at_beyond.m_x.col(kPlace) += x.r.cross(port.t);
  if (!with_inputs) return;
  at_beyond.turn_g = at_port.turn_g;
  at_beyond.m_g = at_port.m_g - follow * at_port.turn_g;
  at_beyond.m_g.middleCols<3>(rod_input::kPortCouple) -= Skew(port.t);
}

/// Fills the residual of the conditions: the port at its place, no moment at the tip, friction at
/// the port.
void EffectShot::Conditions(const ScaledProblem& problem, const EffectRodUnknowns& x) {
  const Eigen::Vector3d r = x.r, lateral = r - r.dot(port.t) * port.t;
  const double along = r.dot(port.t), size = std::hypot(lateral.norm(), kMinLateral);
  residual.head<3>() = problem.WristCompliance() * n_wrist + port.P - problem.span() +
                       problem.PortCompliance() * lateral;
  residual.segment<3>(3) = beyond.end.m;
  residual[6] = along - problem.friction() * size;
}

void EffectShot::ConditionsByUnknowns(const ScaledProblem& problem, const EffectRodUnknowns& x) {
  const Eigen::Vector3d r = x.r, lateral = r - r.dot(port.t) * port.t;
  const double along = r.dot(port.t), size = std::hypot(lateral.norm(), kMinLateral);
  const ByUnknowns dt = -Skew(port.t) * port_turn_x;
  Eigen::Matrix<double, 1, kUnknowns> dalong = r.transpose() * dt;
  dalong.rightCols<3>() += port.t.transpose();
  ByUnknowns dlateral = -along * dt - port.t * dalong;
  dlateral.rightCols<3>() += Eigen::Matrix3d::Identity();
  A.topRows<3>() = at_port.P_x + problem.PortCompliance() * dlateral;
  A.block<3, 1>(0, kPlace) += port.t;
  const auto tip = tip_columns.m.leftCols<6>();
  A.middleRows<3>(3) = tip.leftCols<3>() * at_beyond.turn_x + tip.rightCols<3>() * at_beyond.m_x;
  A.row(6) = dalong - (problem.friction() / size) * (lateral.transpose() * dlateral);
}

}  // namespace flextip::effect_flow
