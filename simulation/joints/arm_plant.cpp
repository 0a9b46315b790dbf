#include "simulation/joints/arm_plant.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"

namespace flextip::simulation {
namespace {

constexpr int kCableSteps = 32;  // of the stiff cables, within a step of the links

double Friction(double coulomb, double viscous, double speed) {
  return coulomb * std::tanh(speed / 2e-3) + viscous * speed;
}

/// The efforts that hold the arm where it stands.
Eigen::VectorXd RestOf(const ArmPlantSettings& settings, const ChainOfLinks& chain,
                       const Eigen::VectorXd& link) {
  return DynamicsOf(chain, settings.masses, link, Eigen::VectorXd::Zero(link.size()),
                    settings.gravity_m_s2)
      .rest;
}

/// The command at a time: a cubic between rows that keeps its speed at each, at rest before the
/// first. Straight pieces would have all their acceleration between the rows, where nobody looks.
Eigen::VectorXd CommandAt(const Eigen::VectorXd& t_s, const Eigen::MatrixXd& commands, double t) {
  const Eigen::Index last = t_s.size() - 1;
  if (t <= t_s[0]) return commands.row(0).transpose();
  if (t >= t_s[last]) return commands.row(last).transpose();
  const double place = (t - t_s[0]) / (t_s[1] - t_s[0]);
  const auto k = std::min<Eigen::Index>(Eigen::Index(place), last - 1);
  const double u = place - double(k);
  const auto speed = [&](Eigen::Index row) -> Eigen::RowVectorXd {
    return 0.5 * (commands.row(std::min(row + 1, last)) -
                  commands.row(std::max<Eigen::Index>(row - 1, 0)));
  };
  const double v = 1.0 - u;
  return (v * v * (1.0 + 2.0 * u) * commands.row(k) + v * v * u * speed(k) +
          u * u * (1.0 + 2.0 * v) * commands.row(k + 1) - u * u * v * speed(k + 1))
      .transpose();
}

}  // namespace

ArmPlant::ArmPlant(const ArmPlantSettings& settings, const Eigen::VectorXd& command, double t_s)
    : settings_(settings), chain_(settings_.arm) {
  const Eigen::Index n = chain_.Size();
  if (settings_.routing.size() == 0) settings_.routing = Eigen::MatrixXd::Identity(n, n);
  state_.t_s = t_s;
  state_.motor = command;
  state_.link = settings_.routing * state_.motor;
  // Cables are stretched, and servos off their commands, by what they hold.
  const Eigen::VectorXd rest = RestOf(settings_, chain_, state_.link),
                        on_motor = settings_.routing.transpose() * rest;
  for (Eigen::Index i = 0; i < n && !settings_.servo_holds_gravity; ++i)
    if (settings_.drives[i].servo_stiffness > 0.0)
      state_.motor[i] -= on_motor[i] / settings_.drives[i].servo_stiffness;
  state_.link = settings_.routing * state_.motor;
  for (Eigen::Index i = 0; i < n; ++i)
    if (rest[i] != 0.0 && settings_.drives[i].cable_stiffness > 0.0)
      state_.link[i] -= rest[i] / settings_.drives[i].cable_stiffness +
                        std::copysign(0.5 * settings_.drives[i].play, rest[i]);
  state_.motor_speed = state_.link_speed = state_.effort = Eigen::VectorXd::Zero(n);
}

void ArmPlant::AdvanceTo(double t_s, const CommandAtTime& command_at) {
  while (state_.t_s < t_s - 1e-9) {
    const double whole = std::min(settings_.links_step_s, t_s - state_.t_s);
    StepOfLinks(whole / kCableSteps, command_at);
  }
  if (!state_.link.allFinite() || !state_.motor.allFinite())
    throw WorkError("the arm's plant does not stay finite: its cables are too stiff for its steps");
}

void ArmPlant::StepOfLinks(double dt, const CommandAtTime& command_at) {
  const Eigen::Index n = chain_.Size();
  ArmPlantState& state = state_;
  const LinkDynamics links =
      DynamicsOf(chain_, settings_.masses, state.link, state.link_speed, settings_.gravity_m_s2);
  Eigen::MatrixXd M = links.M;
  M.diagonal().array() += 2e-3;  // what no joint is without
  const Ldlt inverse(M);
  Eigen::VectorXd held = Eigen::VectorXd::Zero(n);
  if (settings_.servo_holds_gravity) held = RestOf(settings_, chain_, state.link);
  for (int step = 0; step < kCableSteps; ++step) {
    const Eigen::VectorXd command = command_at(state.t_s - settings_.command_delay_s);
    const Eigen::VectorXd pulled = settings_.routing * state.motor,
                          pulled_speed = settings_.routing * state.motor_speed;
    Eigen::VectorXd cable(n), on_link(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const JointDrive& drive = settings_.drives[i];
      const double apart = pulled[i] - state.link[i];
      const double stretch = apart > 0.5 * drive.play    ? apart - 0.5 * drive.play
                             : apart < -0.5 * drive.play ? apart + 0.5 * drive.play
                                                         : 0.0;
      cable[i] = drive.cable_stiffness * stretch;
      if (stretch != 0.0) cable[i] += drive.cable_damping * (pulled_speed[i] - state.link_speed[i]);
      on_link[i] = cable[i] - Friction(drive.link_coulomb, 0.0, state.link_speed[i]);
      state.effort[i] = drive.servo_stiffness * (command[i] - state.motor[i]) -
                        drive.servo_damping * state.motor_speed[i] + held[i];
    }
    const Eigen::VectorXd back = settings_.routing.transpose() * cable;
    for (Eigen::Index i = 0; i < n; ++i) {
      const JointDrive& drive = settings_.drives[i];
      const double friction =
          Friction(drive.motor_coulomb, drive.motor_viscous, state.motor_speed[i]);
      state.motor_speed[i] += dt * (state.effort[i] - back[i] - friction) / drive.motor_inertia;
    }
    state.link_speed += dt * inverse.Solve(Eigen::VectorXd(on_link - links.rest));
    state.motor += dt * state.motor_speed;
    state.link += dt * state.link_speed;
    state.t_s += dt;
  }
}

std::vector<ArmPlantState> RunArm(const ArmPlantSettings& settings, const Eigen::VectorXd& t_s,
                                  const Eigen::MatrixXd& commands) {
  ArmPlant plant(settings, commands.row(0).transpose(), t_s[0]);
  std::vector<ArmPlantState> states;
  for (Eigen::Index row = 0; row < t_s.size(); ++row) {
    plant.AdvanceTo(t_s[row], [&](double t) { return CommandAt(t_s, commands, t); });
    states.push_back(plant.State());
  }
  return states;
}

}  // namespace flextip::simulation
