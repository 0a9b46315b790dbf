// Move, diagnose, plan, move: what the simulated instrument hides is found, by motions within the
// limits.
#include "simulation/closed_loop/diagnosing_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "diagnosis/planning/tip_course.h"
#include "diagnosis/samples/sample_set.h"

namespace flextip::simulation {
namespace {

using testing::ElementsAre;

/// A short first motion beside nothing, under `effects`.
Scenario With(const std::string& effects) {
  const auto file = std::filesystem::path(testing::TempDir()) /
                    ("flextip-diagnosing-" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << R"(
instrument: {length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}
port: {position_m: [0.0, 0.0, 0.17]}
wrist: {start_m: [-0.2457, 0.0, 0.3421], max_speed_m_s: 0.3}
sensors:
  wrist: {rate_hz: 30, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}
  em0: {rate_hz: 30, distance_from_tip_m: 0.02, position_noise_m: 0.00013,
        orientation_noise_rad: 0.00056}
  load: {rate_hz: 30, force_noise_N: 0.005}
  tip: {across_noise_m: 0.0001, depth_noise_m: 0.0006, direction_noise_rad: 0.003,
        line_of_sight: [-0.27, 0.73, -0.63]}
path:
  speed_m_s: 0.015
  waypoints: [{to_m: [0.0, 0.0, -0.01]}, {to_m: [0.0, 0.01, -0.01]}]
controllers: rod-track
effects: )" + effects + "\n";
  Scenario scenario = ReadScenario(file);
  std::filesystem::remove(file);
  return scenario;
}

/// Tag and camera look alike until the shaft turns further than the first motion does.
TEST(DiagnosingLoop, MovesUntilATagIsToldFromACamera) {
  const Scenario scenario = With("{tag_offset: {offset_m: [0.001, -0.0008, 0.0005]}}");
  const DiagnosingResult result = DiagnoseInLoop(scenario, {});
  EXPECT_EQ(result.end, DiagnosingEnd::kSeparated);
  ASSERT_GE(result.rounds.size(), 2u);
  EXPECT_TRUE(result.rounds.front().next.needed);
  EXPECT_LT(result.rounds.front().probability, 0.8);
  EXPECT_THAT(result.rounds.back().answer, ElementsAre("tag_offset"));
  EXPECT_GT(result.rounds.back().probability, 0.8);
  EXPECT_GT(result.diagnosis.presence.at("tag_offset"), 0.95);
  double seconds = 0.0;
  for (const DiagnosingRound& round : result.rounds) seconds += round.seconds;
  EXPECT_DOUBLE_EQ(result.Seconds(), seconds);
}

TEST(DiagnosingLoop, StaysWithinTheLimitsAndHangsNoWeightWhereNoneIsAllowed) {
  const Scenario scenario = With("{tag_offset: {offset_m: [0.001, -0.0008, 0.0005]}}");
  DiagnosingOptions options{.most_rounds = 2};
  options.limits = {
      .seconds = 6.0, .wrist_speed_m_s = 0.05, .angle_rad = 0.2, .may_hang_weight = false};
  const DiagnosingResult result = DiagnoseInLoop(scenario, options);
  const LoopSetup& loop = scenario.loop;
  ASSERT_EQ(result.rounds.size(), 2u);  // or nothing below is looked at
  for (std::size_t i = 1; i < result.rounds.size(); ++i) {
    EXPECT_EQ(result.rounds[i].hung_N, 0.0);
    const auto samples =
        diagnosis::MakeSampleSet(result.rounds[i].run.recording, result.rounds[i].name);
    EXPECT_LT(diagnosis::RecordedSpeed(samples), 0.06);
    const auto space = diagnosis::RecordedWorkspace(samples);
    EXPECT_GT(space.inserted_from_m, 0.34 * loop.base.instrument.length_m);
    EXPECT_LT(space.inserted_to_m, 0.76 * loop.base.instrument.length_m);
    EXPECT_LT(space.angle_rad, 0.45);  // from the middle of this motion
  }
}

TEST(DiagnosingLoop, TheNextRoundGoesOnWhereTheLastOneEnded) {
  const Scenario scenario = With("{}");
  const diagnosis::NextMotion motion{.needed = true,
                                     .places_m = {{0.2, 0.0, 0.0}, {0.2, 0.05, 0.0}},
                                     .speed_m_s = 0.04,
                                     .load_N = 0.3};
  const Scenario next = NextScenario(scenario, motion, {-0.2, 0.01, 0.35}, 1);
  EXPECT_EQ(next.loop.p_RW_start, Eigen::Vector3d(-0.2, 0.01, 0.35));
  EXPECT_EQ(next.loop.path.frame, PathFrame::kRobot);
  EXPECT_EQ(next.loop.path.waypoints_m, motion.places_m);
  EXPECT_NEAR(next.loop.plant.load.constant_N.z(), -0.3, 1e-12);
  EXPECT_NE(next.loop.seed, scenario.loop.seed);
}

}  // namespace
}  // namespace flextip::simulation
