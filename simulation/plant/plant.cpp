#include "simulation/plant/plant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/rotation.h"
#include "simulation/plant/chain.h"
#include "simulation/plant/friction.h"
#include "simulation/plant/tissue.h"
#include "simulation/plant/wrist_reading.h"

namespace flextip::simulation {
namespace {

constexpr double kSoftestRim = 32.0;  // times the rim's stated softness

PlantShape Failed(PlantStatus status, std::string message) {
  PlantShape shape;
  shape.status = status;
  shape.message = std::move(message);
  return shape;
}

/// Why the problem cannot be posed, as a shape with that status; kOk where it can.
PlantShape CheckInput(const PlantSetup& setup, const Eigen::Vector3d& p_RW, double t_s) {
  if (!p_RW.allFinite() || !std::isfinite(t_s)) {
    return Failed(PlantStatus::kBadInput, "wrist or time is not finite");
  }
  const std::string wrong = WhatIsWrong(setup);
  if (!wrong.empty()) return Failed(PlantStatus::kBadInput, wrong);
  const double length = PlantUnits(setup).length_m;
  const double distance = (PortAt(setup, t_s) - p_RW).norm();
  if (distance > 0.995 * length || distance < 0.005 * length) {
    return Failed(PlantStatus::kUnreachable,
                  fmt::format("the port is {:.4f} m from the wrist; a shaft of {:.4f} m needs it "
                              "between 0.5 % and 99.5 % of its length away",
                              distance, length));
  }
  return Failed(PlantStatus::kOk, "");
}

ChainState Straight(const ChainProblem& problem) {
  ChainState state;
  state.s = problem.p_port.norm();
  state.u.assign(static_cast<std::size_t>(problem.Links()), problem.p_port / state.s);
  return state;
}

/// The friction that memory decides upon, with its mode still open.
ChainFriction FrictionLaw(const PortFriction& friction, const PlantUnits& units) {
  ChainFriction law;
  law.stiffness = kStickStiffness_N_m * units.length_m / units.force_N;
  law.coefficient = friction.coefficient;
  law.grip = friction.grip_force_N / units.force_N;
  law.from = friction.grip_from_m / units.length_m;
  law.to = friction.grip_to_m / units.length_m;
  return law;
}

}  // namespace

struct Plant::Call {
  Eigen::Vector3d p_RW_measured, p_RW;  // p_RW: where the arm would hold the wrist without force
  double t_s, dt_s;
  ChainProblem problem;
  ChainState state;
  PlantMemory memory;
  int iterations = 0;
};

Plant::Plant(const PlantSetup& setup, const PlantOptions& options)
    : setup_(setup), options_(options) {
  FLEXTIP_CHECK(options.links_before_port >= 4 && options.links_behind_port >= 4,
                "four links on either side");
}

/// Applies the load in steps, from none to all of it, halving a step that fails.
bool Plant::SolveCold(Call& call) const {
  call.state = Straight(MakeChain(setup_, options_, call.p_RW, call.t_s, 0.0));
  double done = 0.0, step = 1.0;
  while (done < 1.0) {
    const double fraction = std::min(1.0, done + step);
    const ChainProblem problem = MakeChain(setup_, options_, call.p_RW, call.t_s, fraction);
    ChainState trial = call.state;
    const ChainNewton::Result result = ChainNewton(problem).Solve(trial);
    call.iterations += result.iterations;
    // A large jump may have gone to another branch: smaller steps stay on the straight shaft's.
    double turn = 0.0;
    for (int j = 0; j < problem.Links(); ++j) {
      turn = std::max(turn, (trial.u[j] - call.state.u[j]).norm());
    }
    if (result.converged && turn < 0.7) {
      call.state = std::move(trial);
      done = fraction;
      step *= 2.0;
    } else if ((step *= 0.5) < 1e-3) {
      return false;
    }
  }
  return true;
}

/// From `state` to the equilibrium near it. Where a hole with play turns the force too suddenly, by
/// way of softer rims, and on one where there is no way further.
bool Plant::SolveNear(const ChainProblem& problem, ChainState& state, int& iterations) {
  const auto solve = [&iterations, &state](const ChainProblem& posed, ChainState& tried) {
    const ChainNewton::Result result = ChainNewton(posed).Solve(tried);
    iterations += result.iterations;
    return result.converged && (tried.u.back() - state.u.back()).norm() < 0.7;
  };
  ChainState trial = state;
  bool solved = solve(problem, trial);
  if (!solved && problem.port.play > 0.0) {
    ChainProblem softer = problem;
    for (double factor = 256.0; factor >= 1.0; factor *= 0.5) {
      ChainState next = factor == 256.0 ? state : trial;
      softer.port.play_force = factor * problem.port.play_force;
      if (!solve(softer, next)) break;
      trial = std::move(next);
      solved = factor <= kSoftestRim;
    }
  }
  if (solved) state = std::move(trial);
  return solved;
}

/// The equilibrium near the call's state, with what depends on the past.
bool Plant::SolveWithMemory(Call& call) const {
  const PlantEffects& effects = setup_.effects;
  const PlantUnits units(setup_);
  call.problem = MakeChain(setup_, options_, call.p_RW, call.t_s, 1.0);
  ChainSolve solve = [&call](const ChainProblem& problem, ChainState& state) {
    return SolveNear(problem, state, call.iterations);
  };
  const bool dragged = effects.shaft_tissue.stiffness_N_m2 > 0;
  const PlantTissue tissue(effects.shaft_tissue, units, call.p_RW, call.dt_s, memory_.tissue);
  if (dragged) {
    solve = [&tissue, newton = solve](const ChainProblem& problem, ChainState& state) {
      ChainProblem with_tissue = problem;
      return tissue.Solve(with_tissue, state, newton);
    };
  }
  const bool rubs = effects.port_friction.coefficient > 0 || effects.port_friction.grip_force_N > 0;
  if (rubs) {
    call.problem.friction = FrictionLaw(effects.port_friction, units);
    call.memory.friction = memory_.friction;
    if (!SolveWithFriction(call.problem, call.state, call.memory.friction, solve)) return false;
  } else if (!solve(call.problem, call.state)) {
    return false;
  }
  if (dragged) {
    call.memory.tissue = tissue.At(call.problem, call.state);
    tissue.Apply(call.memory.tissue, call.state, call.problem);
  }
  return true;
}

PlantShape Plant::Solve(const Eigen::Vector3d& p_RW, double t_s) {
  PlantShape shape = CheckInput(setup_, p_RW, t_s);
  if (!shape.IsUsable()) return shape;
  Call call;
  call.memory = memory_;
  call.p_RW_measured = p_RW;
  const WristReading& reading = setup_.effects.wrist_reading;
  if (!call.memory.p_RW_first) call.memory.p_RW_first = p_RW;
  const Eigen::Vector3d& about = reading.about_m ? *reading.about_m : *call.memory.p_RW_first;
  call.p_RW = call.memory.backlash.Update(WristOfReading(p_RW, about, setup_.p_RP, reading),
                                          setup_.effects.backlash_m);
  call.t_s = t_s;
  call.dt_s = memory_.t_s ? t_s - *memory_.t_s : 0.0;
  call.memory.t_s = t_s;
  call.state = state_;
  bool solved = warm_ && SolveWithMemory(call);
  if (!solved) {
    solved = SolveCold(call) && SolveWithMemory(call);
  }
  shape.iterations = call.iterations;
  warm_ = solved;
  if (!solved) {
    return Failed(PlantStatus::kNotConverged,
                  "no equilibrium near the straight shaft: the load may be too high");
  }
  FillShape(call, shape);
  state_ = std::move(call.state);
  memory_ = std::move(call.memory);
  return shape;
}

/// Results in SI units, the moments at the joints and the frame carried along the links.
void Plant::FillShape(const Call& call, PlantShape& shape) const {
  const ChainProblem& problem = call.problem;
  const ChainState& state = call.state;
  const ChainGeometry geometry(problem, state.s);
  const PlantUnits units(setup_);
  shape.length_m = units.length_m;
  shape.diameter_m = setup_.instrument.outer_diameter_m;
  shape.s_port_m = units.length_m * state.s;
  shape.f_port_N = units.force_N * state.r;
  shape.f_tip_N = units.force_N * state.f;
  shape.f_wrist_N = -units.force_N * ForceOnArm(problem, state);
  FillPort(call, shape);
  shape.p_RW_measured = call.p_RW_measured;
  shape.tip_yield_m = setup_.effects.tip_compliance_m_N * shape.f_tip_N;
  shape.parts_[0] = {0, 0, problem.n1, 0.0, units.length_m * geometry.h(0)};
  shape.parts_[1] = {problem.n1, problem.n1 + 1, problem.n2, shape.s_port_m,
                     units.length_m * geometry.h(problem.n1)};
  shape.directions_ = state.u;
  shape.nodes_ = ChainNodes(problem, state);
  for (Eigen::Vector3d& x : shape.nodes_) x = call.p_RW + units.length_m * x;
  ChainRest rest;
  for (int i = 0; i < 20; ++i) UpdateRest(problem, state, rest);
  FillMoments(call, rest, shape);
  FillFrames(call, rest, shape);
}

/// The wrist's frame, carried along the links.
void Plant::FillFrames(const Call& call, const ChainRest& rest, PlantShape& shape) const {
  const std::vector<Eigen::Vector3d>& links = call.state.u;
  const double length = PlantUnits(setup_).length_m;
  const ChainGeometry geometry(call.problem, call.state.s);
  const Eigen::Vector3d t_wrist = shape.Tangent(0.0);
  Eigen::Vector3d t = t_wrist;
  Eigen::Matrix3d R = WristAxes(t_wrist, setup_.roll_rad);
  shape.frames_.reserve(links.size());
  double twist = rest.wrist_twist, rate_before = 2.0 * twist / geometry.h(0);
  for (std::size_t j = 0; j < links.size(); ++j) {
    R = RotationWithoutTwist(t, links[j]) * R;
    t = links[j];
    if (rest.twist.empty()) {
      shape.frames_.push_back(R);
      continue;
    }
    shape.frames_.emplace_back(R * ExpRotation(twist * Eigen::Vector3d::UnitX()));
    const bool last = j + 1 == links.size();
    const int joint = static_cast<int>(j);
    const double rate_behind = last ? 0.0 : rest.twist[j] / geometry.JointLength(joint);
    shape.twists_1_m_.push_back(0.5 * (rate_before + rate_behind) / length);
    rate_before = rate_behind;
    if (!last) twist += rest.twist[j];
  }
}

void Plant::FillPort(const Call& call, PlantShape& shape) const {
  const ChainProblem& problem = call.problem;
  const ChainState& state = call.state;
  const PlantUnits units(setup_);
  const PortHinge hinge = HingeOf(problem, ChainGeometry(problem, state.s), state);
  const Eigen::Vector3d& t_port = hinge.tangent;
  const PortYield yield = YieldOf(problem.port, state.r, t_port);
  const double lateral = Lateral(state.r, t_port).norm();
  shape.p_RP = PortAt(setup_, call.t_s) + units.length_m * yield.centre;
  shape.t_port = t_port;
  shape.friction_N = units.force_N * FrictionOf(problem.friction, state.s, lateral).force;
  shape.slips = problem.friction.mode == ChainFriction::Mode::kSlip;
  shape.port_couple_Nm = units.moment_Nm * hinge.couple;
  shape.f_contact_N = Eigen::Vector3d::Zero();
  if (problem.contact) {
    shape.f_contact_N = units.force_N * state.contact * problem.contact->normal;
  }
}

/// At the nodes; at the port the moment jumps by the port's couple.
void Plant::FillMoments(const Call& call, const ChainRest& rest, PlantShape& shape) const {
  const ChainProblem& problem = call.problem;
  const ChainGeometry geometry(problem, call.state.s);
  const double unit = PlantUnits(setup_).moment_Nm;
  const auto moment = [&](int joint) -> Eigen::Vector3d {
    return unit * JointMoment(geometry, call.state, rest, joint);
  };
  shape.moments_.assign(shape.nodes_.size() + 1, Eigen::Vector3d::Zero());
  for (int j = 0; j + 1 < problem.Links(); ++j) {
    shape.moments_[j < problem.n1 ? j + 1 : j + 2] = moment(j);
  }
  const double before = HingeOf(problem, geometry, call.state).before;
  const Eigen::Vector3d at_port = shape.moments_[problem.n1];
  shape.moments_[problem.n1] = at_port + before * shape.port_couple_Nm;
  shape.moments_[problem.n1 + 1] = at_port - (1.0 - before) * shape.port_couple_Nm;
  if (!rest.torque.empty()) {  // what the wrist needs to hold the roll
    shape.moments_.front() = -unit * rest.wrist_torque * shape.Tangent(0.0);
  }
}

}  // namespace flextip::simulation
