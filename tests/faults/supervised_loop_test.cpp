// What the supervisor does for a loop with a fault, by the truth, beside the same loop without.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "simulation/closed_loop/closed_loop.h"
#include "simulation/closed_loop/scenario.h"

namespace flextip::simulation {
namespace {

constexpr double kStart_s = 0.5;

LoopSetup Press(SupervisionKind kind, const std::vector<Fault>& faults = {}) {
  LoopSetup setup =
      ReadScenario(std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml").loop;
  setup.plant_options = {30, 30};
  setup.controller.kind = ControllerKind::kRodTrack;
  setup.supervision.kind = kind;
  setup.supervision.rate_hz = setup.update_rate_hz;
  setup.faults = faults;
  return setup;
}

/// The longest way of the command from one cycle to the next.
double LongestStep(const LoopResult& result) {
  double longest_m = 0.0;
  for (std::size_t i = 1; i < result.updates.size(); ++i) {
    longest_m = std::max(
        longest_m, (result.updates[i].p_RW_command - result.updates[i - 1].p_RW_command).norm());
  }
  return longest_m;
}

TEST(SupervisedLoop, OneTipThatIsWrongMovesNothing) {
  const std::vector<Fault> spike{{FaultKind::kSpike, FaultStream::kTip, kStart_s, 0.1, 0.02}};
  const LoopResult alone = RunClosedLoop(Press(SupervisionKind::kNone, spike), nullptr);
  const LoopResult guarded = RunClosedLoop(Press(SupervisionKind::kFull, spike), nullptr);
  const LoopResult healthy = RunClosedLoop(Press(SupervisionKind::kFull), nullptr);
  EXPECT_GT(alone.max_deviation_m, 0.002);
  EXPECT_LT(guarded.max_deviation_m, healthy.max_deviation_m + 5e-4);
  const bool named = std::any_of(guarded.updates.begin(), guarded.updates.end(), [](const auto& u) {
    return IsOut(u.supervision, VotedSensor::kTip);
  });
  EXPECT_TRUE(named);
}

/// The farthest that the tip went across the path from one cycle to the next.
double FartherInACycle(const LoopResult& result) {
  double most_m = 0.0;
  for (std::size_t i = 1; i < result.updates.size(); ++i)
    most_m = std::max(most_m, result.updates[i].deviation_m - result.updates[i - 1].deviation_m);
  return most_m;
}

/// The press as only the camera sees it.
LoopSetup PressBySight(const std::vector<Fault>& faults) {
  LoopSetup setup = Press(SupervisionKind::kFull, faults);
  setup.sensors.em0.reset();
  setup.sensors.strain.reset();
  setup.sensors.load.reset();
  return setup;
}

// Vision alone, and wrong by less than it can be told to jump.
TEST(SupervisedLoop, ATipInDoubtIsWaitedFor) {
  LoopSetup setup = PressBySight({{FaultKind::kSpike, FaultStream::kTip, kStart_s, 0.1, 0.002}});
  const LoopResult waits = RunClosedLoop(setup, nullptr);
  setup.supervision.doubt_s = 0.0;  // never waits
  const LoopResult believes = RunClosedLoop(setup, nullptr);
  constexpr double kMost_m = 0.001;
  EXPECT_GT(FartherInACycle(believes), kMost_m);
  EXPECT_LT(FartherInACycle(waits), kMost_m);
  int cycles = 0;
  for (const LoopUpdate& update : waits.updates) {
    EXPECT_LT(update.supervision.reaction, Reaction::kHold);
    cycles += update.supervision.doubt != Stop::kNone;
  }
  EXPECT_GE(cycles, 1);
  EXPECT_LE(cycles, 6);
}

TEST(SupervisedLoop, OneTipThatNobodyCanJudgeLeadsTheTipOnlyAPart) {
  LoopSetup setup = PressBySight({{FaultKind::kSpike, FaultStream::kTip, kStart_s, 0.1, 0.002}});
  setup.supervision.doubt_s = 0.0;  // never waits
  const LoopResult free = RunClosedLoop(setup, nullptr);
  setup.supervision.max_tip_deviation_m = 0.002;
  const LoopResult kept = RunClosedLoop(setup, nullptr);
  // 0.8 mm by one sample, and three deviations of what the wrist shakes.
  constexpr double kMost_m = 0.001;
  EXPECT_GT(FartherInACycle(free), kMost_m);
  EXPECT_LT(FartherInACycle(kept), kMost_m);
  const bool said = std::any_of(kept.updates.begin(), kept.updates.end(), [](const auto& update) {
    return update.supervision.stop == Stop::kStep &&
           update.supervision.reaction == Reaction::kLimit;
  });
  EXPECT_TRUE(said);
}

// About the reading no command was long: the limit about the last command takes it.
TEST(SupervisedLoop, OneReadingOfTheWristLeadsTheTipOnlyAPart) {
  LoopSetup setup = PressBySight({{FaultKind::kSpike, FaultStream::kWrist, kStart_s, 0.1, 0.002}});
  setup.supervision.doubt_s = 0.0;  // never waits
  const LoopResult free = RunClosedLoop(setup, nullptr);
  setup.supervision.max_tip_deviation_m = 0.002;
  const LoopResult kept = RunClosedLoop(setup, nullptr);
  // One and a half of 0.8 mm, and three deviations of what the wrist shakes.
  constexpr double kMost_m = 0.0014;
  EXPECT_GT(FartherInACycle(free), kMost_m);
  EXPECT_LT(FartherInACycle(kept), kMost_m);
  EXPECT_LT(kept.max_deviation_m, setup.supervision.max_tip_deviation_m);
}

TEST(SupervisedLoop, OthersCarryATipThatIsCoveredFromItsFirstCycleOnWithoutAJump) {
  const std::vector<Fault> covered{
      {FaultKind::kTagsCovered, FaultStream::kTip, kStart_s, 1.0, 0.0}};
  const LoopResult healthy = RunClosedLoop(Press(SupervisionKind::kFull), nullptr);
  const LoopResult guarded = RunClosedLoop(Press(SupervisionKind::kFull, covered), nullptr);
  for (const LoopUpdate& update : guarded.updates) {
    ASSERT_EQ(update.status, ControlStatus::kOk);
    ASSERT_LT(update.supervision.reaction, Reaction::kHold) << Name(update.supervision.stop);
  }
  EXPECT_LT(guarded.max_deviation_m, healthy.max_deviation_m + 5e-4);
  EXPECT_LT(LongestStep(guarded), 1.5 * LongestStep(healthy));
}

/// A tip that goes away with 2 N on it, and what only the camera, and perhaps the EM sensor, sees.
LoopSetup AwayBySight(bool with_em) {
  LoopSetup setup =
      ReadScenario(std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/chapter4_away.yaml").loop;
  const LoopSetup press = Press(SupervisionKind::kFull);
  setup.sensors = PressBySight({}).sensors;
  if (with_em) setup.sensors.em0 = press.sensors.em0;
  setup.sensors.wrist->rate_hz = setup.sensors.tip->rate_hz = setup.update_rate_hz;
  if (with_em) setup.sensors.em0->rate_hz = setup.update_rate_hz;
  setup.path.mode = PathMode::kContinuous;
  setup.path.speed_m_s = 0.015;
  setup.plant_options = press.plant_options;
  setup.controller.kind = ControllerKind::kRodTrack;
  setup.supervision = press.supervision;
  setup.supervision.max_tip_deviation_m = 0.002;
  setup.max_s = 2.5;
  return setup;
}

/// How much farther than without the faults the tip leaves its path, at most in five runs.
double FartherByFaults(LoopSetup setup, const std::vector<Fault>& faults) {
  double most_m = 0.0;
  for (setup.seed = 1; setup.seed <= 5; ++setup.seed) {
    setup.faults = {};
    const double healthy_m = RunClosedLoop(setup, nullptr).max_deviation_m;
    setup.faults = faults;
    most_m = std::max(most_m, RunClosedLoop(setup, nullptr).max_deviation_m - healthy_m);
  }
  return most_m;
}

// Too slow for the vote, and for a while within what a servo may be beside its way.
TEST(SupervisedLoop, AWristWhoseReadingDriftsIsHeldWhenTheDoubtStays) {
  LoopSetup setup = AwayBySight(true);
  setup.sensors = Press(SupervisionKind::kFull).sensors;
  setup.controller.kind = ControllerKind::kRodCalculate;
  setup.faults = {{FaultKind::kDrift, FaultStream::kWrist, 0.5, 1.0, 0.004}};
  const LoopResult result = RunClosedLoop(setup, nullptr);
  const bool held =
      std::any_of(result.updates.begin(), result.updates.end(), [](const LoopUpdate& update) {
        return update.supervision.reaction >= Reaction::kHold &&
               update.supervision.stop == Stop::kWristNotFollowing;
      });
  EXPECT_TRUE(held);
  setup.supervision.doubt_s = 0.0;
  EXPECT_LT(result.max_deviation_m, RunClosedLoop(setup, nullptr).max_deviation_m - 3e-4);
}

// The load's estimates differ along the shaft by their noise: the tip is carried on all the same.
TEST(SupervisedLoop, ATipThatIsGoneForThreePicturesIsCarriedAlongItsPath) {
  EXPECT_LT(FartherByFaults(AwayBySight(false),
                            {{FaultKind::kDropped, FaultStream::kTip, 1.0, 0.1, 1.0}}),
            5e-4);
}

// The wrist's wrong reading leads the estimate off just when the tip is believed again: that is no
// difference of sources to be taken up once the hold is over.
TEST(SupervisedLoop, WhatHeldTheWristDoesNotLeadItAfterwards) {
  EXPECT_LT(FartherByFaults(AwayBySight(true),
                            {{FaultKind::kOffset, FaultStream::kTip, 0.25, 0.29, 0.5},
                             {FaultKind::kOffset, FaultStream::kWrist, 0.52, 0.1, 0.05}}),
            3e-4);
}

// At each change of sources the tip goes on by what the wrist did, and by no more than the sources
// may differ.
TEST(SupervisedLoop, ATipThatComesAndGoesDoesNotLeadTheWristBesideThePath) {
  LoopSetup setup = Press(SupervisionKind::kFull);
  setup.supervision.max_tip_deviation_m = 0.002;
  EXPECT_LT(FartherByFaults(setup, {{FaultKind::kDropped, FaultStream::kTip, 0.5, 3.0, 0.6}}),
            5e-4);
}

// The camera's tip is all that tells rod-calculate the load.
TEST(SupervisedLoop, ALoopThatCalculatesHoldsWithoutItsSensorAndGoesOnWithIt) {
  constexpr double kLasts_s = 0.5;
  LoopSetup setup =
      PressBySight({{FaultKind::kOffset, FaultStream::kTip, kStart_s, kLasts_s, 0.02}});
  setup.controller.kind = ControllerKind::kRodCalculate;
  const LoopResult result = RunClosedLoop(setup, nullptr);
  const LoopUpdate* last = nullptr;
  int held = 0, moved = 0;
  for (const LoopUpdate& update : result.updates) {
    const double t_s = 1e-9 * static_cast<double>(update.t_ns - kSimulationStart_ns);
    const bool holds = update.supervision.reaction >= Reaction::kHold;
    if (t_s < kStart_s) EXPECT_FALSE(holds) << t_s;
    if (t_s > kStart_s && t_s < kStart_s + kLasts_s) {
      EXPECT_TRUE(holds) << t_s;
      held += holds && update.supervision.stop == Stop::kSourceLost;
      moved += last != nullptr && held > 1 && update.p_RW_command != last->p_RW_command;
    }
    last = &update;
  }
  EXPECT_GE(held, 10);
  EXPECT_EQ(moved, 0);
  EXPECT_LT(last->supervision.reaction, Reaction::kHold);
  EXPECT_FALSE(result.updates.empty());
}

TEST(SupervisedLoop, TipsAreSeenAgainAfterStampsOfTheFuture) {
  for (const SupervisionKind kind : {SupervisionKind::kNone, SupervisionKind::kFull}) {
    LoopSetup setup =
        Press(kind, {{FaultKind::kStampJump, FaultStream::kTip, kStart_s, 0.1, 1000.0}});
    setup.max_s = 8.0;
    setup.sensors.em0.reset();
    setup.sensors.strain.reset();
    setup.sensors.load.reset();
    const LoopResult result = RunClosedLoop(setup, nullptr);
    EXPECT_EQ(result.updates.back().status, ControlStatus::kOk) << Name(kind);
    EXPECT_LT(result.updates.back().supervision.reaction, Reaction::kHold) << Name(kind);
  }
}

TEST(SupervisedLoop, ATipThatPressesTooHardIsHeld) {
  LoopSetup setup = Press(SupervisionKind::kFull);
  setup.supervision.max_tip_force_N = 0.2;  // the press reaches 0.5
  setup.max_s = 3.0;
  const LoopResult result = RunClosedLoop(setup, nullptr);
  double most_N = 0.0;
  bool held = false;
  for (const LoopUpdate& update : result.updates) {
    most_N = std::max(most_N, update.f_tip_N.norm());
    held |= update.supervision.stop == Stop::kForce;
  }
  EXPECT_TRUE(held);
  // The estimate's deviations and the way of one cycle are what it may be late by.
  EXPECT_GT(most_N, 0.2);
  EXPECT_LT(most_N, 0.35);
}

TEST(SupervisedLoop, WithoutOneNothingIsTested) {
  const LoopResult result = RunClosedLoop(Press(SupervisionKind::kNone), nullptr);
  for (const LoopUpdate& update : result.updates) {
    ASSERT_EQ(update.supervision.stop, Stop::kNone);
    ASSERT_EQ(update.supervision.chi2_limit, 0.0);
  }
}

}  // namespace
}  // namespace flextip::simulation
