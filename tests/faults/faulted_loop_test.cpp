// Faults in the closed loop: what a run with one has, beside the same run without.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/error.h"
#include "simulation/closed_loop/closed_loop.h"
#include "simulation/closed_loop/scenario.h"

namespace flextip::simulation {
namespace {

constexpr double kStart_s = 0.5;

LoopSetup Press(const std::vector<Fault>& faults = {}) {
  LoopSetup setup =
      ReadScenario(std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml").loop;
  setup.plant_options = {30, 30};
  setup.faults = faults;
  return setup;
}

LoopResult RunPress(FaultKind kind, FaultStream stream, double size, double duration_s = 0.4) {
  return RunClosedLoop(Press({{kind, stream, kStart_s, duration_s, size}}), nullptr);
}

double Seconds(TimeNs t_ns) { return 1e-9 * static_cast<double>(t_ns - kSimulationStart_ns); }

/// The first cycle with another command.
double FirstDifference(const LoopResult& a, const LoopResult& b) {
  for (std::size_t i = 0; i < std::min(a.updates.size(), b.updates.size()); ++i) {
    if (a.updates[i].p_RW_command != b.updates[i].p_RW_command ||
        a.updates[i].t_ns != b.updates[i].t_ns || a.updates[i].p_RE != b.updates[i].p_RE)
      return Seconds(a.updates[i].t_ns);
  }
  return 1e9;
}

struct Case {
  FaultKind kind;
  FaultStream stream;
  double size;
};

class EachFault : public testing::TestWithParam<Case> {};

/// The fault acts from its begin on, and twice the same.
TEST_P(EachFault, ChangesTheRunFromItsBeginOnAndIsRepeatable) {
  const auto [kind, stream, size] = GetParam();
  const LoopResult healthy = RunClosedLoop(Press(), nullptr);
  const LoopResult faulted = RunPress(kind, stream, size), again = RunPress(kind, stream, size);
  const double first_s = FirstDifference(healthy, faulted);
  EXPECT_GE(first_s, kStart_s);
  EXPECT_LT(first_s, kStart_s + 0.45);
  EXPECT_EQ(FirstDifference(faulted, again), 1e9);
  EXPECT_EQ(faulted.updates.size(), again.updates.size());
}
INSTANTIATE_TEST_SUITE_P(, EachFault,
                         testing::Values(Case{FaultKind::kOffset, FaultStream::kTip, 0.003},
                                         Case{FaultKind::kStuck, FaultStream::kTip, 0.0},
                                         Case{FaultKind::kTagsCovered, FaultStream::kTip, 0.0},
                                         Case{FaultKind::kUnits, FaultStream::kEm0, 1000.0},
                                         Case{FaultKind::kGageBroken, FaultStream::kStrain, 1.0},
                                         Case{FaultKind::kOffset, FaultStream::kWrist, 0.003},
                                         Case{FaultKind::kWristStands, FaultStream::kRobot, 0.0},
                                         Case{FaultKind::kRobotRate, FaultStream::kRobot, 0.01},
                                         Case{FaultKind::kCommandsLost, FaultStream::kRobot, 0.9},
                                         Case{FaultKind::kCycleLate, FaultStream::kRobot, 0.05},
                                         Case{FaultKind::kEncoderSlip, FaultStream::kRobot, 0.002},
                                         Case{FaultKind::kPortMoved, FaultStream::kPlant, 0.01},
                                         Case{FaultKind::kTissueLetsGo, FaultStream::kPlant, 1.0},
                                         Case{FaultKind::kTipCaught, FaultStream::kPlant, 500.0},
                                         Case{FaultKind::kShaftGrasped, FaultStream::kPlant, 1.0}),
                         [](const auto& info) {
                           std::string name =
                               std::string(Name(info.param.kind)) + Name(info.param.stream);
                           std::erase(name, '-');
                           return name;
                         });

TEST(FaultedLoop, TheRecordingHasTheSensorWithoutItsFault) {
  const LoopResult healthy = RunClosedLoop(Press(), nullptr);
  const LoopResult faulted = RunPress(FaultKind::kOffset, FaultStream::kTip, 0.01);
  const auto& tips = faulted.recording.vision0->tips;
  const auto at = std::find_if(tips.begin(), tips.end(),
                               [](const auto& tip) { return Seconds(tip.t_ns) >= kStart_s; });
  ASSERT_NE(at, tips.end());
  // The first sample under the fault: the tip has not moved by it yet.
  const auto i = static_cast<std::size_t>(at - tips.begin());
  EXPECT_EQ(at->value.p_RE, healthy.recording.vision0->tips[i].value.p_RE);
}

TEST(FaultedLoop, AWristThatStandsKeepsItsPlace) {
  const LoopResult run = RunPress(FaultKind::kWristStands, FaultStream::kRobot, 0.0);
  std::vector<Eigen::Vector3d> stood;
  for (const LoopUpdate& update : run.updates) {
    const double t_s = Seconds(update.t_ns);
    if (t_s > kStart_s + 0.01 && t_s < kStart_s + 0.39) stood.push_back(update.p_RW);
  }
  ASSERT_GT(stood.size(), 8U);
  for (const Eigen::Vector3d& p : stood) EXPECT_EQ(p, stood.front());
}

TEST(FaultedLoop, ALateCycleTakesThePlaceOfThoseBeforeIt) {
  const LoopResult run = RunPress(FaultKind::kCycleLate, FaultStream::kRobot, 0.05);
  double longest_s = 0.0;
  for (std::size_t i = 1; i < run.updates.size(); ++i) {
    const double step_s = Seconds(run.updates[i].t_ns) - Seconds(run.updates[i - 1].t_ns);
    EXPECT_GT(step_s, 0.0);
    longest_s = std::max(longest_s, step_s);
  }
  EXPECT_NEAR(longest_s, 1.0 / 30 + 0.05, 1e-6);
}

/// The encoders read on as if nothing were; the true wrist is aside.
TEST(FaultedLoop, AnEncoderThatSlipsShowsInTheTruthAlone) {
  const LoopResult run = RunPress(FaultKind::kEncoderSlip, FaultStream::kRobot, 0.004);
  const auto& readings = run.recording.wrist0->samples;
  ASSERT_EQ(readings.size(), run.truth.size());
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const double off = (readings[i].value.p_RW - run.truth[i].value.p_RW).norm();
    EXPECT_NEAR(off, Seconds(readings[i].t_ns) < kStart_s ? 0.0 : 0.004, 4e-4);
  }
}

TEST(FaultedLoop, AFaultThatEndsTheEquilibriumEndsTheRunWithItsResult) {
  const LoopResult run = RunPress(FaultKind::kPortMoved, FaultStream::kPlant, 2.0);
  EXPECT_FALSE(run.lost_equilibrium.empty());
  ASSERT_FALSE(run.updates.empty());
  EXPECT_GE(Seconds(run.updates.back().t_ns), kStart_s - 0.04);
}

TEST(FaultedLoop, ANumberThatIsNoneDoesNotReachThePlant) {
  const LoopResult run = RunPress(FaultKind::kNotFinite, FaultStream::kWrist, 0.0);
  EXPECT_TRUE(run.lost_equilibrium.empty()) << run.lost_equilibrium;
  for (const auto& sample : run.truth) EXPECT_TRUE(sample.value.p_RE.allFinite());
}

TEST(FaultedLoop, EndsAtItsLongestTime) {
  LoopSetup setup = Press();
  setup.max_s = 0.7;
  EXPECT_NEAR(Seconds(RunClosedLoop(setup, nullptr).updates.back().t_ns), 0.7, 0.034);
}

}  // namespace
}  // namespace flextip::simulation
