#include "simulation/plant.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/rotation.h"

namespace flextip {
namespace {

PlantShape Failed(PlantStatus status, std::string message) {
  PlantShape shape;
  shape.status = status;
  shape.message = std::move(message);
  return shape;
}

/// Why the problem cannot be posed, as a shape with that status; kOk where it can.
PlantShape CheckInput(const PlantSetup& setup, const Eigen::Vector3d& p_RW) {
  const Instrument& shaft = setup.instrument;
  if (!p_RW.allFinite() || !setup.p_RP.allFinite() || !setup.weight_N_m.allFinite() ||
      !setup.load.constant_N.allFinite()) {
    return Failed(PlantStatus::kBadInput, "wrist, port, weight or force is not finite");
  }
  if (!(shaft.length_m > 0) || !(shaft.bending_stiffness_Nm2 > 0) ||
      !std::isfinite(shaft.length_m * shaft.bending_stiffness_Nm2)) {
    return Failed(PlantStatus::kBadInput, "length or bending stiffness is not positive");
  }
  const double distance = (setup.p_RP - p_RW).norm();
  if (distance > 0.995 * shaft.length_m || distance < 0.005 * shaft.length_m) {
    return Failed(PlantStatus::kUnreachable,
                  fmt::format("the port is {:.4f} m from the wrist; a shaft of {:.4f} m needs it "
                              "between 0.5 % and 99.5 % of its length away",
                              distance, shaft.length_m));
  }
  return Failed(PlantStatus::kOk, "");
}

}  // namespace

Plant::Plant(const PlantSetup& setup, const PlantOptions& options)
    : setup_(setup), options_(options) {
  assert(options.links_before_port >= 4 && options.links_behind_port >= 4);
}

/// The problem in units of L and EI / L^2, with the wrist at the origin.
ChainProblem Plant::Problem(const Eigen::Vector3d& p_RW, double load_fraction) const {
  const double length = setup_.instrument.length_m;
  const double force = setup_.instrument.bending_stiffness_Nm2 / (length * length);
  ChainProblem problem;
  problem.n1 = options_.links_before_port;
  problem.n2 = options_.links_behind_port;
  problem.p_port = (setup_.p_RP - p_RW) / length;
  problem.q = load_fraction * setup_.weight_N_m * length / force;
  problem.load = [this, p_RW, load_fraction, length, force](const Eigen::Vector3d& x_tip) {
    const TipForce load = setup_.load.At(p_RW + length * x_tip);
    return ChainForce{load_fraction / force * load.f_N,
                      load_fraction * length / force * load.df_dp_N_m};
  };
  return problem;
}

ChainState Plant::Straight(const ChainProblem& problem) const {
  ChainState state;
  state.s = problem.p_port.norm();
  state.u.assign(static_cast<std::size_t>(problem.Links()), problem.p_port / state.s);
  return state;
}

/// Applies the load in steps, from none to all of it, halving a step that fails.
bool Plant::SolveCold(const Eigen::Vector3d& p_RW, ChainState& state, int& iterations) const {
  state = Straight(Problem(p_RW, 0.0));
  double done = 0.0, step = 1.0;
  while (done < 1.0) {
    const double fraction = std::min(1.0, done + step);
    const ChainProblem problem = Problem(p_RW, fraction);
    ChainState trial = state;
    const ChainNewton::Result result = ChainNewton(problem).Solve(trial);
    iterations += result.iterations;
    // A large jump may have gone to another branch: smaller steps stay on the straight shaft's.
    double turn = 0.0;
    for (int j = 0; j < problem.Links(); ++j) {
      turn = std::max(turn, (trial.u[j] - state.u[j]).norm());
    }
    if (result.converged && turn < 0.7) {
      state = std::move(trial);
      done = fraction;
      step *= 2.0;
    } else if ((step *= 0.5) < 1e-3) {
      return false;
    }
  }
  return true;
}

PlantShape Plant::Solve(const Eigen::Vector3d& p_RW) {
  PlantShape shape = CheckInput(setup_, p_RW);
  if (!shape.IsUsable()) return shape;
  bool solved = false;
  if (warm_) {
    const ChainProblem problem = Problem(p_RW, 1.0);
    ChainState trial = state_;
    const ChainNewton::Result result = ChainNewton(problem).Solve(trial);
    shape.iterations += result.iterations;
    solved = result.converged && (trial.u.back() - state_.u.back()).norm() < 0.7;
    if (solved) state_ = std::move(trial);
  }
  if (!solved) solved = SolveCold(p_RW, state_, shape.iterations);
  warm_ = solved;
  if (!solved) {
    return Failed(PlantStatus::kNotConverged,
                  "no equilibrium near the straight shaft: the load may be too high");
  }
  FillShape(p_RW, shape);
  return shape;
}

/// Results in SI units, the moments at the joints and the frame carried along the links.
void Plant::FillShape(const Eigen::Vector3d& p_RW, PlantShape& shape) const {
  const ChainProblem problem = Problem(p_RW, 1.0);
  const ChainGeometry geometry(problem, state_.s);
  const double length = setup_.instrument.length_m;
  const double moment = setup_.instrument.bending_stiffness_Nm2 / length;
  const double force = moment / length;
  shape.length_m = length;
  shape.diameter_m = setup_.instrument.outer_diameter_m;
  shape.s_port_m = length * state_.s;
  shape.f_port_N = force * state_.r;
  shape.f_tip_N = force * state_.f;
  shape.f_wrist_N = -(shape.f_port_N + shape.f_tip_N + length * setup_.weight_N_m);
  shape.parts_[0] = {0, problem.n1, 0.0, length * geometry.h(0)};
  shape.parts_[1] = {problem.n1, problem.n2, shape.s_port_m, length * geometry.h(problem.n1)};
  shape.directions_ = state_.u;
  shape.nodes_ = ChainNodes(problem, state_);
  for (Eigen::Vector3d& x : shape.nodes_) x = p_RW + length * x;
  shape.moments_.assign(shape.nodes_.size(), Eigen::Vector3d::Zero());
  for (int j = 0; j + 1 < problem.Links(); ++j) {
    shape.moments_[j + 1] = moment * geometry.c(j) * state_.u[j].cross(state_.u[j + 1]);
  }
  const Eigen::Vector3d t_wrist = shape.Tangent(0.0);
  Eigen::Vector3d t = t_wrist;
  Eigen::Matrix3d R = RotationWithoutTwist(Eigen::Vector3d::UnitX(), t_wrist) *
                      ExpRotation(setup_.roll_rad * Eigen::Vector3d::UnitX());
  for (const Eigen::Vector3d& u : state_.u) {
    R = RotationWithoutTwist(t, u) * R;
    t = u;
    shape.frames_.push_back(R);
  }
}

}  // namespace flextip
