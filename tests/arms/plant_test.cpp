// The arm by forces in time (simulation/joints), which shares nothing with the diagnosis.
#include <gtest/gtest.h>

#include "simulation/joints/arm_plant.h"
#include "simulation/joints/arm_recording.h"

namespace flextip::arms {
namespace {

using simulation::SmallArm;

TEST(ArmPlant, EnergyIsKeptWithoutServoAndFriction) {
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
  const auto states = simulation::RunArm(settings, t_s, Eigen::MatrixXd::Constant(41, 3, 0.1));
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
  EXPECT_GT(states.back().link_speed.norm(), 0.5);  // it falls
  const auto& end = states.back();
  const double moving =
      0.5 *
      end.link_speed.dot(
          DynamicsOf(chain, settings.masses, end.link, end.link_speed, settings.gravity_m_s2).M *
          end.link_speed);
  EXPECT_NEAR(energy(end), energy(states.front()), 0.03 * moving);  // by steps of a millisecond
}

}  // namespace
}  // namespace flextip::arms
