// The arm by forces in time (simulation/joints), which shares nothing with the diagnosis.
#include <gtest/gtest.h>

#include <cmath>

#include "simulation/joints/arm_plant.h"
#include "simulation/joints/arm_recording.h"

namespace flextip::arms {
namespace {

using simulation::SmallArm;

TEST(ArmPlant, LosesNoEnergyWithoutServoAndFriction) {
  const Arm arm = SmallArm();
  simulation::ArmPlantSettings settings{.arm = arm, .drives = {}, .masses = {}, .routing = {}};
  settings.servo_holds_gravity = false;
  for (int i = 0; i < 3; ++i) {
    simulation::JointDrive drive;
    drive.servo_stiffness = drive.servo_damping = drive.cable_stiffness = drive.cable_damping = 0.0;
    settings.drives.push_back(drive);
    settings.masses.push_back({i, arm.links[i].mass_kg, arm.links[i].com_m});
  }
  const Eigen::VectorXd t_s = Eigen::VectorXd::LinSpaced(41, 0.0, 0.4);
  const simulation::ChainOfLinks chain(arm);
  const auto energy = [&](const simulation::ArmPlantState& s) {
    const auto dynamics =
        DynamicsOf(chain, settings.masses, s.link, s.link_speed, settings.gravity_m_s2);
    double sum =
        0.5 * s.link_speed.dot(dynamics.M * s.link_speed) + 0.5 * 2e-3 * s.link_speed.squaredNorm();
    for (const auto& mass : settings.masses)
      sum -= mass.mass_kg * settings.gravity_m_s2.dot(chain.Point(s.link, mass));
    return sum;
  };
  const auto lost = [&](double step_s) {
    settings.links_step_s = step_s;
    const auto states = simulation::RunArm(settings, t_s, Eigen::MatrixXd::Constant(41, 3, 0.1));
    EXPECT_GT(states.back().link_speed.norm(), 0.5);  // it falls
    return std::abs(energy(states.back()) - energy(states.front()));
  };
  // What is lost is the steps' alone: of first order, and a step of a tenth keeps the energy.
  EXPECT_NEAR(lost(1e-3) / lost(1e-4), 10.0, 1.5);
  EXPECT_LT(lost(1e-4), 0.02);  // J, of some 2 that move
}

}  // namespace
}  // namespace flextip::arms
