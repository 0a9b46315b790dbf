// Sensors of a plant (another method than the model's) with one of them spoilt: the vote finds it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "pipeline/guard/sensor_guard.h"
#include "pipeline/instrument_controller.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/sensors.h"
#include "tests/control/allocation_counter.h"

namespace flextip {
namespace {

constexpr std::uint8_t Bit(VotedSensor sensor) {
  return static_cast<std::uint8_t>(1U << static_cast<int>(sensor));
}

SupervisorOptions Full() {
  SupervisorOptions options;
  options.kind = SupervisionKind::kFull;
  return options;
}

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

/// A straight shaft in figures: wrist, tip and em0 at 30 Hz.
struct SampleScreening : testing::Test {
  static Instrument Shaft() {
    Instrument shaft;
    shaft.length_m = 0.6;
    shaft.bending_stiffness_Nm2 = 0.304;
    return shaft;
  }
  SensorReadings At(double t_s, const Eigen::Vector3d& p_RW) const {
    SensorReadings readings;
    const TimeNs t_ns = TimeOf(t_s);
    WristMeasurement wrist;
    wrist.p_RW = p_RW;
    wrist.position_noise_m = 5e-5;
    readings.wrist = {t_ns, wrist};
    TipMeasurement tip;
    tip.tip.status = TipStatus::kOk;
    tip.tip.p_RE = Eigen::Vector3d(0, 0, -0.3) + (p_RW - Eigen::Vector3d(0, 0, 0.3));
    tip.tip.covariance_m2 = 1e-8 * Eigen::Matrix3d::Identity();
    readings.tip = {t_ns, tip};
    return readings;
  }
  static TimeNs TimeOf(double t_s) { return 1'000'000'000 + std::llround(1e9 * t_s); }

  SampleScreen screen{Shaft(), Eigen::Vector3d::Zero(), Full()};
  LateSamples late{{}, 1.7};
};

TEST_F(SampleScreening, WhatIsNoNumberOrOldIsTakenOut) {
  const Eigen::Vector3d p_RW(0, 0, 0.3);
  SensorReadings readings = At(0.0, p_RW);
  readings.strain = {TimeOf(0.0), {}};
  readings.strain->value.moments_Nm[2] = std::numeric_limits<double>::quiet_NaN();
  Supervision found;
  screen.Screen(TimeOf(0.0), {}, readings, found);
  EXPECT_FALSE(readings.strain);
  EXPECT_EQ(found.voted_out, Bit(VotedSensor::kStrain));

  readings = At(0.1, p_RW);
  readings.load = {TimeOf(0.1), {}};
  screen.Screen(TimeOf(0.1), {}, readings, found);
  EXPECT_TRUE(readings.load);
  readings = At(0.2, p_RW);
  readings.load = {TimeOf(0.05), {}};
  screen.Screen(TimeOf(0.2), {}, readings, found);
  EXPECT_FALSE(readings.load);

  readings = At(0.3, p_RW);
  readings.wrist->value.p_RW.x() = std::numeric_limits<double>::infinity();
  found = {};
  screen.Screen(TimeOf(0.3), {}, readings, found);
  EXPECT_FALSE(readings.wrist);
  EXPECT_EQ(found.stop, Stop::kNotFinite);
  EXPECT_EQ(found.reaction, Reaction::kHold);
}

TEST_F(SampleScreening, ASampleOfAnotherAgeIsTakenOutUntilAPersonSaysItIsRight) {
  const Eigen::Vector3d p_RW(0, 0, 0.3);
  const auto kept = [&](int cycle, double age_s) {
    const double t_s = cycle / 30.0;
    SensorReadings readings = At(t_s, p_RW);
    readings.em0 = {TimeOf(t_s - age_s), {}};
    readings.em0->value.T_RS.p.x() = 1e-4 * cycle;  // never the same figures
    Supervision found;
    screen.Screen(TimeOf(t_s), {}, readings, found);
    return readings.em0.has_value();
  };
  int cycle = 0;
  for (; cycle < 20; ++cycle) EXPECT_TRUE(kept(cycle, 0.01 + 0.001 * (cycle % 3))) << cycle;
  for (; cycle < 24; ++cycle) EXPECT_FALSE(kept(cycle, 0.06 + 0.001 * (cycle % 3))) << cycle;
  screen.Forget();
  for (; cycle < 28; ++cycle) EXPECT_TRUE(kept(cycle, 0.06)) << cycle;
}

TEST_F(SampleScreening, FiguresThatRepeatWhileTheWristMovesAreTakenOut) {
  int taken_out_at = -1;
  for (int i = 0; i < 10; ++i) {
    const double t_s = i / 30.0;
    SensorReadings readings = At(t_s, {0.002 * t_s, 0, 0.3});
    readings.load = {TimeOf(t_s), {}};  // the same force
    Supervision found;
    screen.Screen(TimeOf(t_s), {}, readings, found);
    if (!readings.load && taken_out_at < 0) taken_out_at = i;
  }
  // 6 deviations of the wrist's noise, 0.3 mm, at 0.067 mm a sample.
  EXPECT_EQ(taken_out_at, 5);
}

TEST_F(SampleScreening, OneRepetitionOfATipWhileTheWristMovesIsADoubt) {
  for (int i = 0; i < 3; ++i) {
    const double t_s = i / 30.0;
    const Eigen::Vector3d p_RW(0.001 * i, 0, 0.3);
    SensorReadings readings = At(t_s, p_RW);
    readings.tip.emplace();
    readings.tip->t_ns = TimeOf(t_s);
    TipObservation& tip = readings.tip->value.tip;
    tip.status = TipStatus::kOk;
    tip.p_RE = {i == 0 ? 0.001 : 0.002, 0.0, 0.1};
    tip.covariance_m2 = 1e-8 * Eigen::Matrix3d::Identity();
    Supervision found;
    screen.Screen(TimeOf(t_s), {}, readings, found);
    screen.ScreenTip(TimeOf(t_s), readings.tip, p_RW, found);
    EXPECT_TRUE(readings.tip);
    EXPECT_EQ(found.doubt, i == 2 ? Stop::kStaleTip : Stop::kNone) << i;
  }
}

TEST_F(SampleScreening, AWristThatStandsMayRepeatItself) {
  for (int i = 0; i < 100; ++i) {
    SensorReadings readings = At(i / 30.0, {0, 0, 0.3});
    readings.load = {TimeOf(i / 30.0), {}};
    Supervision found;
    screen.Screen(TimeOf(i / 30.0), {}, readings, found);
    ASSERT_TRUE(readings.load);
    ASSERT_EQ(found.reaction, Reaction::kNone);
  }
}

TEST_F(SampleScreening, ATipMayMoveAsTheFreeShaftOrNotAtAllButNotJump) {
  const Eigen::Vector3d p_RW(0, 0, 0.3);
  const SensorReadings first = At(0.0, p_RW);
  late.Note(first);
  screen.BelieveTip(first, late);
  // The wrist goes 3 mm to the side: the free tip goes 3 mm to the other.
  SensorReadings next = At(0.033, p_RW + Eigen::Vector3d(0.003, 0, 0));
  late.Note(next);
  Eigen::Vector3d& p_RE = next.tip->value.tip.p_RE;
  for (const double x_m : {0.0, -0.0015, -0.003}) {
    p_RE = Eigen::Vector3d(x_m, 0, -0.3);
    EXPECT_FALSE(screen.TipJumps(next, late)) << x_m;
  }
  for (const double x_m : {0.003, -0.007, 0.02}) {
    p_RE = Eigen::Vector3d(x_m, 0, -0.3);
    EXPECT_TRUE(screen.TipJumps(next, late)) << x_m;
  }
  screen.Forget();
  EXPECT_FALSE(screen.TipJumps(next, late));
}

TEST(PortDepth, TooLittleShaftBeyondThePortHolds) {
  for (const double inside_m : {0.2, 0.597}) {
    InstrumentControllerOptions options;
    Instrument instrument;
    instrument.length_m = 0.6;
    instrument.bending_stiffness_Nm2 = 0.304;
    options.estimator = EstimatorOptionsFor(instrument, {0.0, 0.0, 0.1}, Eigen::Vector3d::Zero());
    options.supervision = Full();
    InstrumentController controller(options);
    ControllerInputs inputs;
    inputs.t_ns = 1'000'000'000;
    inputs.sensors.wrist.emplace();
    inputs.sensors.wrist->t_ns = inputs.t_ns;
    inputs.sensors.wrist->value.p_RW = {0.0, 0.0, 0.1 + inside_m};
    inputs.sensors.wrist->value.position_noise_m = 5e-5;
    inputs.sensors.tip.emplace();
    inputs.sensors.tip->t_ns = inputs.t_ns;
    TipObservation& tip = inputs.sensors.tip->value.tip;
    tip.status = TipStatus::kOk;
    tip.p_RE = {0.0, 0.0, 0.1 + inside_m - 0.6};
    tip.covariance_m2 = 1e-8 * Eigen::Matrix3d::Identity();
    inputs.p_RE_desired = tip.p_RE;
    const Supervision found = controller.Step(inputs).supervision;
    EXPECT_EQ(found.stop == Stop::kPortDepth, inside_m > 0.59) << Name(found.stop);
  }
}

}  // namespace
}  // namespace flextip
