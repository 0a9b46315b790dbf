// Sensors of a plant (another method than the model's) with one of them spoilt: the vote finds it.
#include <gtest/gtest.h>

#include <memory>

#include "pipeline/guard/sensor_vote.h"
#include "pipeline/sensor_readings.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/sensors.h"
#include "tests/control/allocation_counter.h"
#include "tests/pipeline/full_supervision.h"

namespace flextip {
namespace {

using test_support::Bit;
using test_support::Full;

/// A shaft that is pressed by a force, and its sensors' noise.
struct PressedShaft {
  PressedShaft() {
    setup.instrument.length_m = 0.6;
    setup.instrument.outer_diameter_m = 0.00238;
    setup.instrument.bending_stiffness_Nm2 = 0.304;
    setup.p_RP = {0.0, 0.0, 0.17};
    setup.load.constant_N = {0.0, 0.05, 0.15};
    simulation::Plant plant(setup, {30, 30});
    shape = plant.Solve({-0.2457, 0.0, 0.3421});
    simulation::SensorSetup sensors_setup;
    sensors_setup.wrist.emplace();
    sensors_setup.wrist->position_noise_m = 5e-5;
    sensors_setup.wrist->orientation_noise_rad = 3e-4;
    sensors_setup.em0.emplace();
    sensors_setup.em0->distance_from_tip_m = 0.02;
    sensors_setup.em0->position_noise_m = 1.3e-4;
    sensors_setup.em0->orientation_noise_rad = 5.6e-4;
    sensors_setup.strain.emplace();
    sensors_setup.strain->station_from_wrist_m[0] = 0.15;
    sensors_setup.strain->station_from_wrist_m[1] = 0.5;
    sensors_setup.strain->moment_noise_Nm = 8e-4;
    sensors_setup.tip.emplace();
    sensors = std::make_unique<simulation::Sensors>(sensors_setup, 5);
  }

  SensorReadings Next() {
    t_ns += 1'000'000'000;  // all sensors are due
    Recording recording;
    sensors->Sample(shape, t_ns, recording);
    return NewestReadings(recording);
  }

  simulation::PlantSetup setup;
  simulation::PlantShape shape;
  std::unique_ptr<simulation::Sensors> sensors;
  TimeNs t_ns = simulation::kSimulationStart_ns;
};

struct SensorVoting : testing::Test {
  PressedShaft shaft;
  EstimatorOptions estimator =
      EstimatorOptionsFor(shaft.setup.instrument, shaft.setup.p_RP, Eigen::Vector3d::Zero());
  SensorVote vote{estimator, Full()};

  Supervision Ask(const Measurements& measured) {
    Measurements z = measured;
    Supervision found;
    vote.Vote(shaft.t_ns, 0, {}, z, found);
    return found;
  }
};

TEST_F(SensorVoting, HealthySensorsAgree) {
  for (int i = 0; i < 2000; ++i) {
    const Supervision found = Ask(*Gather(shaft.Next()));
    ASSERT_EQ(found.voted_out, 0) << i;
    ASSERT_EQ(found.reaction, Reaction::kNone) << i;
  }
}

TEST_F(SensorVoting, ChiSquaredIsThatOfItsDegreesButForTheWidePrior) {
  SupervisorOptions exact = Full();
  exact.tolerances = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};  // plant and model are the same instrument
  vote = SensorVote(estimator, exact);
  double sum = 0.0;
  int degrees = 0;
  constexpr int kDraws = 1000;
  for (int i = 0; i < kDraws; ++i) {
    const Measurements z = *Gather(shaft.Next());
    sum += Ask(z).chi2;
    degrees = 3 + 2 + 3 + 2 + 4 + 2;  // tip, direction, em0, its direction, strain, wrist's turn
  }
  // Three forces and the port are fitted against priors that are not drawn here.
  EXPECT_LT(sum / kDraws, degrees);
  EXPECT_GT(sum / kDraws, degrees - 7);
}

TEST_F(SensorVoting, TheSpoiltSensorIsOut) {
  // What the sensors are off all the while is known after a second.
  for (int i = 0; i < 30; ++i) Ask(*Gather(shaft.Next()));
  for (const double offset_m : {0.004, 0.008, 0.02, 0.2}) {
    Measurements z = *Gather(shaft.Next());
    z.tip->p_RE += Eigen::Vector3d(0.0, offset_m, 0.0);
    EXPECT_EQ(Ask(z).voted_out, Bit(VotedSensor::kTip)) << offset_m;
    shaft.t_ns += 1'000'000'000;
    z = *Gather(shaft.Next());
    z.em->T_RS.p += Eigen::Vector3d(0.0, 0.0, offset_m);
    EXPECT_EQ(Ask(z).voted_out, Bit(VotedSensor::kEm)) << offset_m;
    shaft.t_ns += 1'000'000'000;
    z = *Gather(shaft.Next());
    z.strain->moments_Nm[1] += 10.0 * offset_m;
    EXPECT_EQ(Ask(z).voted_out, Bit(VotedSensor::kStrain)) << offset_m;
    shaft.t_ns += 1'000'000'000;
  }
}

TEST_F(SensorVoting, ASensorThatIsOffByLittleHoldsAtLeast) {
  for (int i = 0; i < 30; ++i) Ask(*Gather(shaft.Next()));
  for (const bool of_tip : {true, false}) {
    Measurements z = *Gather(shaft.Next());
    (of_tip ? z.tip->p_RE : z.em->T_RS.p) += Eigen::Vector3d(0.0, 0.003, 0.0);
    const Supervision found = Ask(z);
    EXPECT_TRUE(found.voted_out != 0 || found.stop == Stop::kTipDisagrees) << of_tip;
    shaft.t_ns += 1'000'000'000;
  }
}

TEST_F(SensorVoting, DoubtsAreNoMoreOftenThanStatedAndSeeWhatAgreesStill) {
  SupervisorOptions exact = Full();
  exact.tolerances = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};  // plant and model are the same instrument
  exact.doubt = 0.01;
  vote = SensorVote(estimator, exact);
  constexpr int kDraws = 2000;
  int doubts = 0, seen = 0;
  for (int i = 0; i < kDraws; ++i) {
    doubts += Ask(*Gather(shaft.Next())).doubt != Stop::kNone;
    if (i % 20 != 0) continue;
    Measurements z = *Gather(shaft.Next());
    z.em->T_RS.p += Eigen::Vector3d(0.0, 0.0, 0.0012);  // agrees still with all together
    const Supervision found = Ask(z);
    seen += found.reaction == Reaction::kNone && found.doubt == Stop::kTipDisagrees;
  }
  // Of five sensors and the wrist's reading, each one in a hundred: 120, less what they share.
  EXPECT_GT(doubts, 40);
  EXPECT_LT(doubts, 150);
  EXPECT_GT(seen, kDraws / 20 / 2);  // half of them
}

TEST_F(SensorVoting, ASensorThatIsOutLeavesNoDoubt) {
  for (int i = 0; i < 30; ++i) Ask(*Gather(shaft.Next()));
  int doubts = 0;
  for (int i = 0; i < 100; ++i) {
    Measurements z = *Gather(shaft.Next());
    z.em->T_RS.p += Eigen::Vector3d(0.0, 0.2, 0.0);
    const Supervision found = Ask(z);
    EXPECT_EQ(found.voted_out, Bit(VotedSensor::kEm));
    doubts += found.doubt != Stop::kNone;
  }
  EXPECT_LE(doubts, 2);
}

TEST_F(SensorVoting, OffsetsWithinToleranceAreLearnt) {
  const auto spoilt = [&](double offset_m) {
    Measurements z = *Gather(shaft.Next());
    z.em->T_RS.p += Eigen::Vector3d(0.0, 0.0, offset_m);
    return Ask(z);
  };
  for (int i = 0; i < 300; ++i) EXPECT_EQ(spoilt(0.0005).reaction, Reaction::kNone) << i;
  // Once it is known, a leap of 2 mm is one; to learn 2 mm is no tolerance.
  EXPECT_NE(spoilt(0.003).voted_out, 0);
  shaft.t_ns += 1'000'000'000;
  int agrees = 0;
  for (int i = 0; i < 300; ++i) {
    const Supervision found = spoilt(0.0005 + 0.00001 * i);
    agrees += found.voted_out == 0 && found.reaction == Reaction::kNone;
  }
  EXPECT_LT(agrees, 290);
}

TEST_F(SensorVoting, AWristElsewhereIsNamedAndNoSensorIsBlamed) {
  for (int i = 0; i < 30; ++i) Ask(*Gather(shaft.Next()));
  Measurements z = *Gather(shaft.Next());
  z.p_RW += Eigen::Vector3d(0.0, 0.02, 0.0);
  const Supervision found = Ask(z);
  EXPECT_EQ(found.stop, Stop::kWristNotFollowing);
  EXPECT_EQ(found.reaction, Reaction::kHold);
  EXPECT_EQ(found.voted_out, 0);
}

TEST_F(SensorVoting, AMovedPortIsNamedAndNoSensorIsBlamed) {
  estimator.p_RP += Eigen::Vector3d(0.0, 0.01, 0.0);
  SensorVote moved(estimator, Full());
  Measurements z = *Gather(shaft.Next());
  Supervision found;
  moved.Vote(shaft.t_ns, 0, {}, z, found);
  EXPECT_EQ(found.voted_out, 0);
  EXPECT_EQ(found.stop, Stop::kPortMoved);
  EXPECT_EQ(found.reaction, Reaction::kHold);
}

// A vote that ends nowhere takes longer than a cycle: it must not be taken in each.
TEST_F(SensorVoting, WhereNoneIsNamedTwiceTheNextVoteWaits) {
  for (const int unnamed : {1, 2}) {
    SensorVote fresh(estimator, Full());
    const auto ask = [&](double off_m, TimeNs after_ns) {
      shaft.t_ns += after_ns;
      Measurements z = *Gather(shaft.Next());
      shaft.t_ns -= 1'000'000'000;
      z.p_RW.z() += off_m;
      Supervision found;
      fresh.Vote(shaft.t_ns, 0, {}, z, found);
      return found;
    };
    Supervision last;
    for (int i = 0; i < unnamed; ++i) {
      last = ask(0.1, 33'000'000);
      EXPECT_EQ(last.reaction, Reaction::kHold);
      EXPECT_EQ(last.voted_out, 0);
    }
    const Supervision next = ask(0.0, 33'000'000);
    EXPECT_EQ(next.reaction, unnamed == 2 ? Reaction::kHold : Reaction::kNone) << unnamed;
    if (unnamed == 2) {
      EXPECT_EQ(next.stop, last.stop);
      EXPECT_EQ(next.chi2, last.chi2);
    }
    EXPECT_EQ(ask(0.0, 100'000'000).reaction, Reaction::kNone);  // half of resume_after_s
  }
}

TEST_F(SensorVoting, ASensorThatWasOutComesBackAfterAWhile) {
  Measurements z = *Gather(shaft.Next());
  z.tip->p_RE.y() += 0.01;
  EXPECT_EQ(Ask(z).voted_out, Bit(VotedSensor::kTip));
  z.tip->p_RE.y() -= 0.01;
  shaft.t_ns += 100'000'000;
  EXPECT_EQ(Ask(z).voted_out, Bit(VotedSensor::kTip));
  shaft.t_ns += 150'000'000;
  EXPECT_EQ(Ask(z).voted_out, 0);
}

TEST_F(SensorVoting, OfASensorThatStaysOutTheOthersAreAskedAloneUntilTheyDisagree) {
  constexpr TimeNs kCycle_ns = 33'000'000;
  const Measurements right = *Gather(shaft.Next());
  Measurements tip_off = right;
  tip_off.tip->p_RE.y() += 0.02;
  const Supervision first = Ask(tip_off);
  EXPECT_EQ(first.voted_out, Bit(VotedSensor::kTip));
  shaft.t_ns += kCycle_ns;
  const Supervision second = Ask(tip_off);
  EXPECT_EQ(second.voted_out, Bit(VotedSensor::kTip));
  EXPECT_EQ(second.reaction, Reaction::kNone);
  // By the linear model of the others it is as far off as it was.
  EXPECT_GT(second.chi2, 0.5 * first.chi2);
  EXPECT_LT(second.chi2, 2.0 * first.chi2);
  // Another one fails while the first has become right again.
  Measurements em_off = right;
  em_off.em->T_RS.p.z() += 0.02;
  shaft.t_ns += kCycle_ns;
  EXPECT_EQ(Ask(em_off).voted_out, Bit(VotedSensor::kEm));
  // Or as well: no one sensor is to blame.
  em_off.tip->p_RE.y() += 0.02;
  shaft.t_ns += kCycle_ns;
  EXPECT_EQ(Ask(em_off).reaction, Reaction::kHold);
}

TEST_F(SensorVoting, AllocatesNothing) {
  Measurements z = *Gather(shaft.Next());
  Ask(z);
  const long before = AllocationCount();
  z.tip->p_RE.y() += 0.01;
  Ask(z);
  EXPECT_EQ(AllocationCount(), before);
}

}  // namespace
}  // namespace flextip
