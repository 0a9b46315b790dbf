// The supervisor's state machine and its watch over the wrist, by motions made by hand.
#include "control/supervision/supervisor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "control/supervision/chi_squared.h"
#include "core/draw_vector.h"

namespace flextip {
namespace {

const Eigen::Vector3d kWrist(0.0, 0.0, 0.4);

TimeNs At(double t_s) { return 1'000'000'000 + std::llround(1e9 * t_s); }

SupervisorOptions Full() {
  SupervisorOptions options;
  options.kind = SupervisionKind::kFull;
  options.rates = {0.01, 0.2, 5.0};
  return options;
}

SupervisedCycle Cycle(double t_s, const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_wish) {
  SupervisedCycle cycle;
  cycle.t_ns = At(t_s);
  cycle.p_RW = p_RW;
  cycle.p_RW_noise_m = 5e-5;
  cycle.p_wish = p_wish;
  return cycle;
}

Supervision Found(Stop stop, Reaction reaction) {
  Supervision found;
  found.stop = stop;
  found.reaction = reaction;
  return found;
}

TEST(Supervisor, LetsAQuietCommandThrough) {
  Supervisor supervisor(Full());
  const Eigen::Vector3d wish = kWrist + Eigen::Vector3d(1e-5, 0, 0);
  const auto decision = supervisor.Decide(Cycle(0.0, kWrist, wish));
  EXPECT_EQ(decision.supervision.reaction, Reaction::kNone);
  EXPECT_EQ(*decision.p_RW_command, wish);
}

TEST(Supervisor, HoldsOnePlaceAndGoesOnByItself) {
  Supervisor supervisor(Full());
  const double dt_s = 1.0 / 30.0;
  int held = 0;
  std::optional<Eigen::Vector3d> place;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d noisy = kWrist + Eigen::Vector3d(0, i % 2 ? 1e-5 : -1e-5, 0);
    SupervisedCycle cycle = Cycle(i * dt_s, noisy, noisy + Eigen::Vector3d(1e-5, 0, 0));
    if (i >= 10 && i < 15) cycle.found = Found(Stop::kTipJump, Reaction::kHold);
    const auto decision = supervisor.Decide(cycle);
    if (decision.supervision.reaction != Reaction::kHold) continue;
    ++held;
    EXPECT_EQ(decision.supervision.stop, Stop::kTipJump);
    if (place) EXPECT_EQ(*decision.p_RW_command, *place);
    place = decision.p_RW_command;
  }
  // Five cycles of cause, and 0.2 s without.
  EXPECT_EQ(held, 5 + 6);
}

/// The command of a hold, where the robot went along x and its reading is `reading` then.
Eigen::Vector3d HeldAt(const Eigen::Vector3d& reading) {
  Supervisor supervisor(Full());
  constexpr double kLag_m = 0.002;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d wish = kWrist + Eigen::Vector3d(0.02 * i / 30.0, 0, 0);
    supervisor.Decide(Cycle(i / 30.0, wish - Eigen::Vector3d(kLag_m, 0, 0), wish));
  }
  SupervisedCycle cycle = Cycle(1.0, reading, reading);
  cycle.found = Found(Stop::kForce, Reaction::kHold);
  return *supervisor.Decide(cycle).p_RW_command;
}

TEST(Supervisor, AHoldStopsARobotOnItsWayAtOnce) {
  const Eigen::Vector3d reading = kWrist + Eigen::Vector3d(0.0175, 0.0001, 0);
  EXPECT_LT((HeldAt(reading) - (kWrist + Eigen::Vector3d(0.0175, 0, 0))).norm(), 1e-9);
}

TEST(Supervisor, AHoldDoesNotFollowAReadingBesideTheWay) {
  const Eigen::Vector3d last = kWrist + Eigen::Vector3d(0.02 * 29.0 / 30.0, 0, 0);
  EXPECT_EQ(HeldAt(kWrist + Eigen::Vector3d(0.0175, 0.01, 0)), last);
  EXPECT_EQ(HeldAt(Eigen::Vector3d::Constant(std::nan(""))), last);
}

TEST(Supervisor, AGoalWaitsForAWristThatStands) {
  for (const bool stands : {true, false}) {
    Supervisor supervisor(Full());
    bool waits = false;
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d wish = kWrist + Eigen::Vector3d(0.02 * i / 30.0, 0, 0);
      const Eigen::Vector3d reading = stands ? kWrist : wish - Eigen::Vector3d(0.0015, 0, 0);
      const auto decision = supervisor.Decide(Cycle(i / 30.0, reading, wish));
      EXPECT_EQ(decision.supervision.reaction, Reaction::kNone) << i;
      waits |= decision.supervision.waits;
    }
    EXPECT_EQ(waits, stands);
  }
}

TEST(Supervisor, AWristWaitsForADoubtToGoAndADoubtThatStaysHolds) {
  // A tip that may be astray must move to come back: it is waited for, and no more.
  for (const Stop stop : {Stop::kTipDisagrees, Stop::kTipAstray}) {
    Supervisor supervisor(Full());
    const double dt_s = 1.0 / 30.0;
    std::vector<int> waited, held;
    for (int i = 0; i < 60; ++i) {
      SupervisedCycle cycle = Cycle(i * dt_s, kWrist, kWrist + Eigen::Vector3d(1e-4, 0, 0));
      const bool in_doubt = i == 5 || i >= 20;
      if (in_doubt) cycle.found.doubt = stop;
      // A step that is too long, too: where the wrist waits it is not what counts.
      cycle.found.stop = Stop::kStep;
      cycle.found.reaction = Reaction::kLimit;
      const Supervision supervision = supervisor.Decide(cycle).supervision;
      if (!supervision.waits) continue;
      EXPECT_EQ(supervision.stop, stop);
      (supervision.reaction == Reaction::kLimit ? waited : held).push_back(i);
    }
    // One cycle, and 0.6 s of a doubt that stays: 18 cycles.
    ASSERT_EQ(waited.size(), 19u);
    EXPECT_EQ(waited.front(), 5);
    EXPECT_EQ(waited.back(), 37);
    EXPECT_EQ(held.size(), stop == Stop::kTipDisagrees ? 22u : 0u);
  }
}

TEST(Supervisor, AReadingBesideTheCommandedWayIsADoubt) {
  // 0.5 mm and six deviations, 0.92 mm, may be settling and noise; from 0.7 of it on it is
  // doubtful.
  for (const double beside_m : {0.0, 0.0006, 0.0007}) {
    Supervisor supervisor(Full());
    int waits = 0;
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector3d wish = kWrist + Eigen::Vector3d(0.0005 * i, 0, 0);
      const Eigen::Vector3d lags = wish - Eigen::Vector3d(0.001, i >= 20 ? beside_m : 0.0, 0);
      const auto decision = supervisor.Decide(Cycle(i / 30.0, lags, wish));
      EXPECT_LT(decision.supervision.reaction, Reaction::kHold);
      waits += decision.supervision.stop == Stop::kWristNotFollowing;
    }
    EXPECT_EQ(waits > 0, beside_m > 0.00065) << beside_m;
  }
}

// A reading that leaps by less than what holds: the robot must not be led to where it points.
TEST(Supervisor, AReadingInDoubtIsNoPlaceToStop) {
  Supervisor supervisor(Full());
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d wish = kWrist + Eigen::Vector3d(0.0005 * i, 0, 0);
    const Eigen::Vector3d off(0.0, i == 20 ? 0.0009 : 0.0, 0.0);
    SupervisedCycle cycle = Cycle(i / 30.0, wish - Eigen::Vector3d(0.001, 0, 0) + off, wish);
    cycle.found.chi2 = 5.0;  // the sensors agree
    cycle.found.chi2_limit = 50.0;
    const auto decision = supervisor.Decide(cycle);
    EXPECT_EQ(decision.supervision.stop == Stop::kWristNotFollowing, i == 20) << i;
    ASSERT_TRUE(decision.p_RW_command);
    EXPECT_EQ(decision.p_RW_command->y(), kWrist.y()) << i;
  }
}

TEST(Supervisor, AWristWaitsForATipThatIsHidden) {
  Supervisor supervisor(Full());
  supervisor.Decide(Cycle(0.0, kWrist, kWrist));
  SupervisedCycle cycle = Cycle(1.0 / 30.0, kWrist, kWrist + Eigen::Vector3d(0.001, 0, 0));
  cycle.tip_is_hidden = true;
  const auto decision = supervisor.Decide(cycle);
  EXPECT_EQ(decision.supervision.stop, Stop::kStaleTip);
  EXPECT_EQ(decision.supervision.reaction, Reaction::kLimit);
  EXPECT_TRUE(decision.supervision.waits);
  EXPECT_EQ(*decision.p_RW_command, kWrist);
}

TEST(Supervisor, CyclesThatAreLateInARowHold) {
  Supervisor supervisor(Full());
  double t_s = 0.0;
  int held = 0, late = 0;
  for (int i = 0; i < 60; ++i) {
    const bool is_late = i == 10 || (i >= 30 && i < 34);
    t_s += is_late ? 0.06 : 1.0 / 30.0;
    late = is_late ? late + 1 : 0;
    const auto decision = supervisor.Decide(Cycle(t_s, kWrist, kWrist));
    if (late >= 3) EXPECT_EQ(decision.supervision.stop, Stop::kDeadline) << i;
    held += decision.supervision.reaction == Reaction::kHold;
    if (i < 32) EXPECT_EQ(held, 0) << i;
  }
  EXPECT_GT(held, 0);
}

TEST(Supervisor, AHoldThatLastsBecomesAFaultUntilSomebodyResumes) {
  Supervisor supervisor(Full());
  const double dt_s = 1.0 / 30.0;
  int first_fault = -1, first_free = -1;
  for (int i = 0; i < 200; ++i) {
    SupervisedCycle cycle = Cycle(i * dt_s, kWrist, kWrist);
    if (i < 70) cycle.found = Found(Stop::kTipDisagrees, Reaction::kHold);
    cycle.resume = i == 150;
    const auto decision = supervisor.Decide(cycle);
    if (decision.supervision.reaction == Reaction::kFault && first_fault < 0) first_fault = i;
    if (decision.supervision.reaction == Reaction::kNone && first_free < 0) first_free = i;
    EXPECT_EQ(decision.resumed, i == 150);
  }
  EXPECT_EQ(first_fault, 61);  // later than 2 s
  EXPECT_EQ(first_free, 150);
}

TEST(Supervisor, FindsAWristThatStandsWhileItIsSentOn) {
  Supervisor supervisor(Full());
  double found_s = -1.0;
  for (int i = 0; i < 60 && found_s < 0.0; ++i) {
    const double t_s = i / 30.0;
    const Eigen::Vector3d wish = kWrist + Eigen::Vector3d(0.01 * t_s, 0, 0);
    const auto decision = supervisor.Decide(Cycle(t_s, kWrist, wish));
    if (decision.supervision.stop == Stop::kWristNotFollowing) found_s = t_s;
  }
  // 10 mm/s away from it: noise and settling pass for 0.92 mm, the lag for 0.25 s.
  EXPECT_NEAR(found_s, 0.092 + 0.25 + 1.0 / 30.0, 2.0 / 30.0);
}

TEST(Supervisor, AWristThatLagsWithinItsLagIsNotAstray) {
  Supervisor supervisor(Full());
  std::mt19937_64 rng(3);
  std::normal_distribution<double> noise(0.0, 5e-5);
  for (int i = 0; i < 3000; ++i) {
    const double t_s = i / 30.0;
    const auto way = [](double t) {
      return Eigen::Vector3d(0.02 * std::sin(2.0 * t), 0.01 * std::cos(3.1 * t), 0.0);
    };
    const Eigen::Vector3d measured = kWrist + way(t_s - 0.15) + DrawVector<3>(noise, rng);
    const auto decision = supervisor.Decide(Cycle(t_s, measured, kWrist + way(t_s)));
    ASSERT_NE(decision.supervision.stop, Stop::kWristNotFollowing) << t_s;
  }
}

TEST(Supervisor, ACommandThatIsNoNumberNeverGoesOut) {
  Supervisor supervisor(Full());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto decision = supervisor.Decide(Cycle(0.0, kWrist, {nan, 0, 0}));
  EXPECT_EQ(decision.supervision.stop, Stop::kNotFinite);
  EXPECT_EQ(*decision.p_RW_command, kWrist);
}

TEST(Supervisor, TimeThatStandsHolds) {
  Supervisor supervisor(Full());
  supervisor.Decide(Cycle(0.0, kWrist, kWrist));
  const auto decision = supervisor.Decide(Cycle(0.0, kWrist, kWrist + Eigen::Vector3d::UnitX()));
  EXPECT_EQ(decision.supervision.stop, Stop::kBadTime);
  EXPECT_EQ(*decision.p_RW_command, kWrist);
}

TEST(Supervisor, CommandsStayWithinTheRatesThroughHoldsAndResumes) {
  SupervisorOptions options = Full();
  options.rate_hz = 120.0;
  Supervisor supervisor(options);
  std::mt19937_64 rng(11);
  std::normal_distribution<double> wander(0.0, 0.01);
  std::bernoulli_distribution stops(0.03);
  const double dt_s = 1.0 / 120.0;
  Eigen::Vector3d wrist = kWrist, last = kWrist;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d wish = wrist + DrawVector<3>(wander, rng);
    SupervisedCycle cycle = Cycle(i * dt_s, wrist, wish);
    if (stops(rng)) cycle.found = Found(Stop::kTipJump, Reaction::kHold);
    const auto decision = supervisor.Decide(cycle);
    EXPECT_LE((*decision.p_RW_command - last).norm(),
              options.rates.max_speed_m_s * dt_s * (1.0 + 1e-9));
    last = *decision.p_RW_command;
    wrist = last;
  }
}

TEST(ChiSquaredLimits, AreThoseOfTheTables) {
  // Abramowitz and Stegun, table 26.8.
  const ChiSquaredLimits limits(0.001);
  EXPECT_NEAR(limits.Of(1), 10.8276, 1e-4);
  EXPECT_NEAR(limits.Of(5), 20.5150, 1e-4);
  EXPECT_NEAR(limits.Of(20), 45.3147, 1e-4);
  EXPECT_TRUE(std::isinf(limits.Of(0)));
}

}  // namespace
}  // namespace flextip
