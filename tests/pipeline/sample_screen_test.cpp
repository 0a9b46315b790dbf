// Samples by themselves: what the screen takes out. And the port too near an end of the shaft.
#include <gtest/gtest.h>

#include <limits>

#include "pipeline/guard/sample_screen.h"
#include "pipeline/instrument_controller.h"
#include "tests/pipeline/full_supervision.h"

namespace flextip {
namespace {

using test_support::Bit;
using test_support::Full;

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
