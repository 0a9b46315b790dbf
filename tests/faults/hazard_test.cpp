// What counts as a hazard, on series made by hand.
#include "bench/fault_campaign/hazard.h"

#include <gtest/gtest.h>

#include <limits>

namespace flextip::bench {
namespace {

constexpr double kDt_s = 0.1;

HazardLimits SomeLimits() {
  return {.deviation_m = 0.002,
          .fixture_depth_m = 0.0005,
          .tip_force_N = 1.0,
          .step_m = 0.01,
          .speed_m_s = 0.1,
          .acceleration_m_s2 = 1.0};
}

/// A wrist that goes 1 mm a cycle along x and is commanded 1 mm ahead; nothing else happens.
std::vector<TrueCycle> Quiet(int cycles = 20) {
  std::vector<TrueCycle> series;
  for (int i = 0; i < cycles; ++i) {
    TrueCycle& cycle = series.emplace_back();
    cycle.t_s = kDt_s * i;
    cycle.fixture_depth_m = -0.01;
    cycle.p_RW = {0.001 * i, 0.0, 0.0};
    cycle.p_RW_command = {0.001 * (i + 1), 0.0, 0.0};
  }
  return series;
}

Hazards Judge(const std::vector<TrueCycle>& series, double from_s = 0.0) {
  return JudgeHazards(series, SomeLimits(), from_s, {});
}

TEST(Hazards, AreNoneInAQuietRun) {
  const Hazards hazards = Judge(Quiet());
  EXPECT_EQ(hazards.Text(), "none");
  EXPECT_FALSE(hazards.first_s);
}

TEST(Hazards, ATipOffThePathCountsWhereTheWristMoves) {
  auto series = Quiet();
  for (int i = 10; i < 20; ++i) series[static_cast<std::size_t>(i)].deviation_m = 0.0021;
  const Hazards hazards = Judge(series);
  EXPECT_EQ(hazards.Text(), "path");
  EXPECT_DOUBLE_EQ(*hazards.first_s, 1.0);
  EXPECT_DOUBLE_EQ(hazards.deviation_m, 0.0021);
}

TEST(Hazards, AWristThatStandsOffThePathDoesNotCount) {
  auto series = Quiet();
  for (std::size_t i = 10; i < 20; ++i) {
    series[i].deviation_m = 0.01;
    series[i].p_RW = series[i].p_RW_command = series[9].p_RW_command;
    if (i == 10) series[i].p_RW = series[9].p_RW;
  }
  EXPECT_EQ(Judge(series).Text(), "path");  // it still went there in cycle 11
  series[11].deviation_m = 0.0095;          // but it came nearer
  series[10].p_RW = series[9].p_RW;
  EXPECT_EQ(Judge(series).Text(), "none");
}

TEST(Hazards, ACommandOfThisCycleHasNotMovedTheWristYet) {
  auto series = Quiet();
  for (std::size_t i = 5; i < 20; ++i) {
    series[i].p_RW = series[i].p_RW_command = {0.005, i % 2 == 0 ? 6e-5 : 0.0, 0.0};  // it shakes
    series[i].p_RW_command = {0.005, 0.0, 0.0};
    if (i > 8) series[i].deviation_m = 0.01;
  }
  series[19].p_RW_command = {0.004, 0.0, 0.0};
  EXPECT_EQ(Judge(series).Text(), "none");
  series[18].p_RW_command = {0.0045, 0.0, 0.0};
  EXPECT_EQ(Judge(series).Text(), "path");
}

TEST(Hazards, AWayBackToThePathDoesNotCount) {
  auto series = Quiet();
  for (std::size_t i = 5; i < 15; ++i)
    series[i].deviation_m = 0.010 - 0.0005 * static_cast<double>(i);
  series[4].deviation_m = 0.010;
  series[3].deviation_m = 0.010;
  // Cycle 3 is the jump; it lies before the begin.
  EXPECT_EQ(Judge(series, 0.45).Text(), "none");
  EXPECT_EQ(Judge(series, 0.0).Text(), "path");
}

TEST(Hazards, WhatThePlantItselfThrowsDoesNotCountInItsTime) {
  auto series = Quiet();
  for (std::size_t i = 5; i < 8; ++i) series[i].deviation_m = 0.005;
  EXPECT_EQ(JudgeHazards(series, SomeLimits(), 0.0, {{0.5, 0.8}}).Text(), "none");
  EXPECT_EQ(JudgeHazards(series, SomeLimits(), 0.0, {{0.5, 0.7}}).Text(), "path");
}

TEST(Hazards, TheFixtureAndTheForceHaveTheirLimits) {
  auto series = Quiet();
  series[7].fixture_depth_m = 0.0004;
  series[7].tip_force_N = 0.9;
  EXPECT_EQ(Judge(series).Text(), "none");
  series[7].fixture_depth_m = 0.0006;
  EXPECT_EQ(Judge(series).Text(), "fixture");
  series[7].tip_force_N = 1.1;
  EXPECT_EQ(Judge(series).Text(), "fixture force");
}

TEST(Hazards, CommandsHaveLimitsOfStepSpeedAndAcceleration) {
  auto step = Quiet();
  for (TrueCycle& cycle : step) cycle.p_RW_command += Eigen::Vector3d(0.0, 0.0098, 0.0);
  EXPECT_EQ(Judge(step).Text(), "none");  // 9.85 mm from the wrist
  for (TrueCycle& cycle : step) cycle.p_RW_command += Eigen::Vector3d(0.0, 0.0005, 0.0);
  EXPECT_EQ(Judge(step).Text(), "command");
  auto speed = Quiet();
  for (std::size_t i = 10; i < 20; ++i) speed[i].p_RW_command.y() += 0.0098;
  EXPECT_EQ(Judge(speed).Text(), "none");  // 98.5 mm/s, 0.98 m/s^2
  for (std::size_t i = 10; i < 20; ++i) speed[i].p_RW_command.y() += 0.0004;
  EXPECT_EQ(Judge(speed).Text(), "command");
  auto none = Quiet();
  none[5].p_RW_command.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Judge(none).Text(), "command");
}

TEST(Hazards, NothingBeforeTheBeginCounts) {
  auto series = Quiet();
  series[3].deviation_m = 1.0;
  series[3].p_RW_command.y() = 1.0;
  EXPECT_EQ(Judge(series, 0.65).Text(), "none");
}

TEST(HazardLimits, GrowWithTheHealthyRun) {
  const Limits limits{
      .rates = {.max_step_m = 0.01, .max_speed_m_s = 0.1, .max_acceleration_m_s2 = 1.0},
      .tip_force_N = 2.0};
  const HazardLimits fine = HazardLimitsOf(limits, {.deviation_m = 0.0019});
  EXPECT_FALSE(fine.coarse);
  EXPECT_DOUBLE_EQ(fine.deviation_m, 0.002);
  EXPECT_DOUBLE_EQ(fine.tip_force_N, 2.1);
  EXPECT_DOUBLE_EQ(fine.fixture_depth_m, 0.0005);
  const HazardLimits coarse =
      HazardLimitsOf(limits, {.deviation_m = 0.003, .fixture_depth_m = 0.001, .tip_force_N = 3.0});
  EXPECT_TRUE(coarse.coarse);
  EXPECT_DOUBLE_EQ(coarse.deviation_m, 0.005);
  EXPECT_DOUBLE_EQ(coarse.tip_force_N, 3.6);
  EXPECT_DOUBLE_EQ(coarse.fixture_depth_m, 0.0015);
}

TEST(Extremes, AreTheLargestOfASeries) {
  auto series = Quiet();
  series[4].deviation_m = 0.004;
  series[6].tip_force_N = 2.0;
  const Extremes most = ExtremesOf(series);
  EXPECT_DOUBLE_EQ(most.deviation_m, 0.004);
  EXPECT_DOUBLE_EQ(most.tip_force_N, 2.0);
  EXPECT_NEAR(most.step_m, 0.001, 1e-12);
  EXPECT_NEAR(most.speed_m_s, 0.01, 1e-12);
  EXPECT_NEAR(most.acceleration_m_s2, 0.0, 1e-12);
}

}  // namespace
}  // namespace flextip::bench
