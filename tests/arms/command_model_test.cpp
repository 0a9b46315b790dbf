// What a controller is handed of a found model: its numbers, and the efforts that it expects,
// against the diagnosis' own equations and against the plant's differences of positions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "arms/feed_forward/joint_model.h"
#include "arms/feed_forward/sampled_path.h"
#include "arms/model/dynamics.h"
#include "core/error.h"
#include "simulation/joints/arm_recording.h"
#include "tests/arms/made_arm.h"
#include "tests/control/allocation_counter.h"

namespace flextip::arms {
namespace {

using diagnosis::EffectFit;
using testing::ElementsAre;
using testing::StartsWith;

const Eigen::Vector3d kGravity(0.3, -0.5, -9.7);

EffectFit Fit(const std::string& effect,
              const std::vector<std::pair<std::string, std::vector<double>>>& lists) {
  EffectFit fit{effect, {}};
  for (const auto& [name, values] : lists)
    fit.parameters.push_back({name, values, std::vector<double>(values.size(), 0.0)});
  return fit;
}

TEST(CommandModel, TakesTheModelsNumbers) {
  const ArmModel model{
      {Fit("command_latency", {{"delay_s", {0.04}}}),
       Fit("joint_coupling", {{"matrix", {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}}}),
       Fit("joint_backlash", {{"width", {0.02, 0.0, 0.001}}, {"drag", {0.0, 0.0, 0.5, 0, 0, 0}}}),
       Fit("link_geometry", {})},
      {Fit("servo_lag", {{"time_s", {0.01, -0.002, 0.03}}})},
      {},
      {}};
  const CommandModel found = CommandModelOf(simulation::SmallArm(), model, kGravity);
  const JointModel& joints = found.joints;
  EXPECT_EQ(joints.delay_s, 0.04);
  EXPECT_EQ(joints.coupling(1, 0), 0.3);  // the second row's first
  EXPECT_EQ(joints.coupling(2, 1), 0.6);
  EXPECT_EQ(joints.play(0, 0), 0.02);
  EXPECT_EQ(joints.play(1, 0), 0.01);  // half of what joint 1 takes up
  EXPECT_EQ(joints.lag_s[1], 0.0);     // no lag is negative
  EXPECT_EQ(joints.lag_s[2], 0.03);
  EXPECT_EQ(joints.scale[0], 1.0);
  EXPECT_FALSE(joints.turns[2]);
  EXPECT_THAT(found.not_corrected, ElementsAre(StartsWith("link_geometry: ")));
}

// Springs draw joints back that drag each other: by a width and half at joint 1, half of one at 2.
TEST(CommandModel, TakesSpringsOfJointsThatDragEachOther) {
  const ArmModel model{
      {Fit("joint_backlash", {{"width", {0.2, 0.1, 0.0}},
                              {"drag", {-0.5, 0.0, 0.0, 0.0, 0.0, 0.0}},
                              {"window", {0.2, 0.1, 0.0}},
                              {"carried", {0.0, -0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}}})},
      {},
      {Fit("play_spring", {{"pull_back", {1.5, 0.5, 7.0}}})},
      {}};
  const JointModel joints = CommandModelOf(simulation::SmallArm(), model, kGravity).joints;
  EXPECT_NEAR(joints.scale[0], 1.0 - 1.5 * 0.2, 1e-12);
  EXPECT_NEAR(joints.scale[1], 1.0 - 0.5 * 0.1, 1e-12);
  EXPECT_EQ(joints.scale[2], 1.0);  // alone it has no such spring
  EXPECT_NEAR(joints.coupling(0, 1), 0.5 * 0.05, 1e-12);
  EXPECT_EQ(joints.coupling(1, 0), 0.0);
}

TEST(CommandModel, RefusesAModelOfAnotherArm) {
  const ArmModel two{{Fit("joint_offset", {{"offset", {0.1, 0.2}}})}, {}, {}, {}};
  EXPECT_THROW(CommandModelOf(simulation::SmallArm(), two, kGravity), InputError);
  const ArmModel place{{Fit("payload", {{"mass_kg", {0.1}}, {"place", {9.0}}})},
                       {},
                       {Fit("masses", {{"link_numbers", std::vector<double>(30, 0.0)},
                                       {"motor_inertia", {0, 0, 0}},
                                       {"spring", {0, 0, 0}},
                                       {"effort_zero", {0, 0, 0}}})},
                       {}};
  EXPECT_THROW(CommandModelOf(simulation::SmallArm(), place, kGravity), InputError);
}

TEST(CommandModel, ExpectsTheEffortsOfTheDiagnosis) {
  const Arm arm = SixJoints();
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  const auto drawn = [&](int size) {
    std::vector<double> values;
    for (int i = 0; i < size; ++i) values.push_back(normal(rng));
    return values;
  };
  const std::vector<double> numbers = drawn(60), motor = drawn(6), spring = drawn(6),
                            zero = drawn(6);
  const ArmModel model{{},
                       {},
                       {Fit("masses", {{"link_numbers", numbers},
                                       {"motor_inertia", motor},
                                       {"spring", spring},
                                       {"effort_zero", zero}})},
                       {}};
  const CommandModel found = CommandModelOf(arm, model, kGravity);
  ASSERT_TRUE(found.joints.effort);
  const Eigen::Map<const Eigen::VectorXd> link(numbers.data(), 60);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<double> q = drawn(6), v = drawn(6), a = drawn(6);
    const Motion motion{Eigen::Map<const Eigen::VectorXd>(q.data(), 6),
                        Eigen::Map<const Eigen::VectorXd>(v.data(), 6),
                        Eigen::Map<const Eigen::VectorXd>(a.data(), 6)};
    Eigen::VectorXd expected = EffortRegressor(Kinematics(arm), motion, kGravity) * link;
    for (int i = 0; i < 6; ++i)
      expected[i] += motor[std::size_t(i)] * motion.a[i] + spring[std::size_t(i)] * motion.q[i] +
                     zero[std::size_t(i)];
    const Eigen::VectorXd effort = found.joints.effort->Of(motion.q, motion.v, motion.a);
    EXPECT_LT((effort - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(CommandModel, ExpectsTheEffortsOfThePlant) {
  const Arm arm = simulation::SmallArm();
  const CommandModel found = CommandModelOf(arm, {}, kGravity);
  std::vector<simulation::PointMass> masses;
  for (int i = 0; i < 3; ++i)
    masses.push_back({i, arm.links[std::size_t(i)].mass_kg, arm.links[std::size_t(i)].com_m});
  const Eigen::Vector3d q(0.3, -0.4, 0.12), v(0.7, -0.5, 0.2), a(1.0, 2.0, -0.5);
  const auto plant = DynamicsOf(simulation::ChainOfLinks(arm), masses, q, v, kGravity);
  const Eigen::Vector3d expected = plant.M * a + plant.rest;
  EXPECT_LT((Eigen::Vector3d(found.joints.effort->Of(q, v, a)) - expected).norm(), 1e-5);
}

TEST(SampledPath, IsSmoothBetweenRowsAndRestsBeyondThem) {
  Track rows{Eigen::VectorXd::LinSpaced(101, 0.0, 2.0), Eigen::MatrixXd(101, 1)};
  rows.values.col(0) = (3.0 * rows.t_s.array()).sin();
  const SampledPath path(rows);
  for (double t = 0.2; t < 1.8; t += 0.037) {
    EXPECT_NEAR(path.JointsAt(t)[0], std::sin(3.0 * t), 1e-5);
    EXPECT_NEAR(path.RatesAt(t)[0], 3.0 * std::cos(3.0 * t), 0.01);
  }
  EXPECT_EQ(path.JointsAt(-1.0)[0], 0.0);
  EXPECT_EQ(path.JointsAt(9.0)[0], std::sin(6.0));
  EXPECT_EQ(path.RatesAt(9.0)[0], 0.0);
  JointFeedForward feed_forward(JointModel(1), {}, JointVector::Zero(1));
  if (CountsAllocations()) {
    const long before = AllocationCount();
    for (double t = 0.0; t < 2.0; t += 0.01) feed_forward.Step(path.WishAt(t, feed_forward), 0.01);
    EXPECT_EQ(AllocationCount(), before);
  }
  rows.t_s[50] = rows.t_s[49];
  EXPECT_THROW(SampledPath{rows}, InputError);
}

}  // namespace
}  // namespace flextip::arms
