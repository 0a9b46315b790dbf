#include "kinematics/shaft_shape.h"

#include "kinematics/beam.h"
#include "kinematics/plane_beam.h"
#include "kinematics/straight.h"

namespace flextip {
namespace {

constexpr int kPoints = 201;

double Along(int i, double length_m) { return length_m * i / (kPoints - 1); }

Shape Failed(const std::string& status, bool bad_input) {
  Shape shape;
  shape.status = status;
  shape.bad_input = bad_input;
  return shape;
}

Shape RodShape(const RodProblem& problem) {
  RodSolver solver;
  const RodState rod = solver.Solve(problem);
  if (!rod.IsUsable()) return Failed(Name(rod.status), rod.status != RodStatus::kNotConverged);
  Shape shape;
  shape.status = "ok";
  shape.p_tip = rod.tip.p;
  shape.t_wrist = rod.wrist.t;
  shape.t_tip = rod.tip.t;
  shape.s_port_m = rod.s_port_m;
  shape.f_port = rod.f_port;
  shape.f_wrist = rod.f_wrist;
  shape.m_half_wrist = solver.Section(0.5 * rod.s_port_m).m;
  shape.m_half_tip = solver.Section(0.5 * (rod.s_port_m + problem.length_m)).m;
  for (int i = 0; i < kPoints; ++i) {
    shape.points.push_back(solver.Section(Along(i, problem.length_m)).p);
  }
  return shape;
}

/// The reactions that balance forces and moments of a shaft that is (nearly) straight along `t`,
/// and the moments they cause in it. The port pushes across `t` only.
void AddStraightStatics(const RodProblem& problem, const Eigen::Vector3d& t, Shape& shape) {
  const double L = problem.length_m, s_port = shape.s_port_m;
  const auto across = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d { return v - v.dot(t) * t; };
  const Eigen::Vector3d weight = L * problem.q_weight;
  shape.f_port = -(L * across(problem.f_tip) + 0.5 * L * across(weight)) / s_port;
  shape.f_wrist = -(problem.f_tip + weight + shape.f_port);
  const auto moment = [&](double s) -> Eigen::Vector3d {
    Eigen::Vector3d m = (L - s) * t.cross(problem.f_tip);
    m += 0.5 * (L - s) * (L - s) * t.cross(problem.q_weight);
    if (s < s_port) m += (s_port - s) * t.cross(shape.f_port);
    return m;
  };
  shape.m_half_wrist = moment(0.5 * s_port);
  shape.m_half_tip = moment(0.5 * (s_port + L));
}

Shape StraightShape(const RodProblem& problem) {
  const auto straight = SolveStraight(problem.p_wrist, problem.p_port, problem.length_m);
  if (!straight.IsUsable()) return Failed(Name(straight.status), true);
  Shape shape;
  shape.status = "ok";
  shape.p_tip = straight.p_tip;
  shape.t_wrist = shape.t_tip = straight.t;
  shape.s_port_m = (problem.p_port - problem.p_wrist).norm();
  AddStraightStatics(problem, straight.t, shape);
  for (int i = 0; i < kPoints; ++i) {
    shape.points.emplace_back(problem.p_wrist + Along(i, problem.length_m) * straight.t);
  }
  return shape;
}

/// The thesis's beam takes the place along the chord for that along the shaft.
Shape BeamShape(const RodProblem& problem) {
  if (!problem.q_weight.isZero()) return Failed("the beam has no self-weight", true);
  const BeamFit fit = SolveBeam(problem.p_wrist, problem.p_port, problem.f_tip,
                                problem.bending_stiffness_Nm2, problem.length_m);
  if (fit.status == BeamStatus::kStraight) return StraightShape(problem);
  if (!fit.IsUsable()) return Failed(Name(fit.status), true);
  const double F = fit.F_p_over_EI, a = fit.a, L = problem.length_m;
  const auto point = [&](double x, double y) -> Eigen::Vector3d {
    return problem.p_wrist + fit.R_RM * Eigen::Vector3d(x, y, 0.0);
  };
  const auto tangent = [&](double x) -> Eigen::Vector3d {
    return fit.R_RM * Eigen::Vector3d(1.0, BeamSlope(F, a, L, x), 0.0).normalized();
  };
  Shape shape;
  shape.status = "ok";
  shape.p_tip = BeamTip(fit, problem.p_wrist);
  shape.t_wrist = tangent(0.0);
  shape.t_tip = tangent(L);
  shape.s_port_m = a;
  AddStraightStatics(problem, fit.R_RM.col(0), shape);
  const double shortened = (shape.p_tip - problem.p_wrist).norm() / L;
  for (int i = 0; i < kPoints; ++i) {
    const double x = Along(i, L);
    shape.points.push_back(point(x * shortened, BeamHeight(F, a, L, x)));
  }
  return shape;
}

}  // namespace

Shape SolveShape(const RodProblem& problem, ShapeModel model) {
  const bool finite = problem.p_wrist.allFinite() && problem.p_port.allFinite() &&
                      problem.f_tip.allFinite() && problem.q_weight.allFinite();
  if (!finite || !(problem.length_m > 0) || !(problem.bending_stiffness_Nm2 > 0)) {
    return Failed(Name(RodStatus::kBadInput), true);
  }
  switch (model) {
    case ShapeModel::kBeam:
      return BeamShape(problem);
    case ShapeModel::kStraight:
      return StraightShape(problem);
    case ShapeModel::kRod:
      break;
  }
  return RodShape(problem);
}

}  // namespace flextip
