// Late tips carried on: against the plant, which bends its shaft by another method.
#include "pipeline/late_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/plant/plant.h"

namespace flextip {
namespace {

const Instrument kInstrument{0.6, 0.00238, 0.304, 0.0};
const Eigen::Vector3d kPort(0.0, 0.0, 0.17), kWrist(-0.2457, 0.0, 0.3421);
const Eigen::Vector3d kForce(0.2, -0.15, 0.4);
constexpr double kTissueGain = 1.7;
constexpr TimeNs kStart_ns = 1'700'000'000'000'000'000, kPeriod_ns = 8'333'333;

Eigen::Vector3d WristAt(int cycle) {
  const double t_s = 1e-9 * static_cast<double>(cycle * kPeriod_ns);
  return kWrist + 0.02 * Eigen::Vector3d(std::sin(2.0 * t_s), std::cos(1.3 * t_s) - 1.0, 0.4 * t_s);
}

SensorReadings WristOnly(int cycle) {
  SensorReadings readings;
  readings.wrist = {kStart_ns + cycle * kPeriod_ns, {WristAt(cycle), {}, 5e-5, 3e-4}};
  return readings;
}

Sample<TipMeasurement> Tip(TimeNs t_ns, const Pose& T_RE) {
  TipMeasurement tip;
  tip.tip.status = TipStatus::kOk;
  tip.tip.p_RE = T_RE.p;
  tip.tip.d_RE = T_RE.R.col(0);
  tip.tip.covariance_m2 = 1e-8 * Eigen::Matrix3d::Identity();
  tip.direction_noise_rad = 0.003;
  return {t_ns, tip};
}

class LateTip : public ::testing::Test {
 protected:
  LateTip() : plant_(PressedShaft(), {60, 60}) {
    model_.instrument = kInstrument;
    model_.p_RP = kPort;
    model_.f_tip_N = kForce;
    model_.force_known = true;
  }
  static simulation::PlantSetup PressedShaft() {
    simulation::PlantSetup setup;
    setup.instrument = kInstrument;
    setup.p_RP = kPort;
    setup.load.constant_N = kForce;
    return setup;
  }
  Pose TrueTip(int cycle) { return plant_.Solve(WristAt(cycle)).T_RE(); }

  simulation::Plant plant_;
  ShaftModel model_;
};

TEST_F(LateTip, IsWhereThePlantPutsIt) {
  for (const int late : {4, 8, 30}) {
    LateSamples samples({}, kTissueGain);
    for (int i = 0; i < 100; ++i) samples.Note(WristOnly(i));
    SensorReadings now = WristOnly(99);
    const Pose then = TrueTip(99 - late), truth = TrueTip(99);
    now.tip = Tip(now.wrist->t_ns - late * kPeriod_ns, then);
    ASSERT_TRUE(samples.HasLateTip(now));
    ASSERT_TRUE(samples.Carry(model_, now));
    const double way_m = (truth.p - then.p).norm();
    EXPECT_GT(way_m, 5e-4);
    EXPECT_LT((now.tip->value.tip.p_RE - truth.p).norm(), 0.01 * way_m) << late;
    EXPECT_LT((*now.tip->value.tip.d_RE - truth.R.col(0)).norm(), 2e-3);
    EXPECT_GT(now.tip->value.tip.covariance_m2.trace(), 3e-8);
  }
}

TEST_F(LateTip, OfTheWristsTimeStaysAsItIs) {
  LateSamples samples({}, kTissueGain);
  SensorReadings now = WristOnly(0);
  samples.Note(now);
  const Pose T_RE = TrueTip(0);
  now.tip = Tip(now.wrist->t_ns, T_RE);
  EXPECT_FALSE(samples.HasLateTip(now));
  EXPECT_FALSE(samples.Carry(model_, now));
  EXPECT_EQ(now.tip->value.tip.p_RE, T_RE.p);
  EXPECT_EQ(now.tip->value.tip.covariance_m2, 1e-8 * Eigen::Matrix3d::Identity());
}

TEST_F(LateTip, IsDroppedWhereThePastIsNotKnown) {
  LateSamples samples({}, kTissueGain);
  for (int i = 50; i < 60; ++i) samples.Note(WristOnly(i));
  SensorReadings now = WristOnly(59);
  now.tip = Tip(kStart_ns, TrueTip(0));
  EXPECT_FALSE(samples.Carry(model_, now));
  EXPECT_FALSE(now.tip);
}

TEST_F(LateTip, TheTimesDeviationCountsByTheSpeed) {
  LateSampleOptions options;
  options.tip_time_sd_s = 0.004;
  LateSamples sharp({}, kTissueGain), blurred(options, kTissueGain);
  for (int i = 0; i < 40; ++i) {
    sharp.Note(WristOnly(i));
    blurred.Note(WristOnly(i));
  }
  const int late = 8;
  SensorReadings a = WristOnly(39);
  a.tip = Tip(a.wrist->t_ns - late * kPeriod_ns, TrueTip(39 - late));
  SensorReadings b = a;
  sharp.Carry(model_, a);
  blurred.Carry(model_, b);
  const Eigen::Vector3d speed_m_s =
      (TrueTip(40 - late).p - TrueTip(38 - late).p) / (2e-9 * static_cast<double>(kPeriod_ns));
  const Eigen::Matrix3d more = b.tip->value.tip.covariance_m2 - a.tip->value.tip.covariance_m2;
  const Eigen::Matrix3d expected = 0.004 * 0.004 * speed_m_s * speed_m_s.transpose();
  EXPECT_LT((more - expected).norm(), 0.1 * expected.norm());
}

TEST_F(LateTip, OtherSensorsTakeOverWhereTheLoadChanges) {
  // A tenth of the load went since the tip was seen; the rod does not know, the other sensors do.
  simulation::PlantSetup unloaded = PressedShaft();
  unloaded.load.constant_N *= 0.9;
  simulation::Plant free(unloaded, {60, 60});
  LateSampleOptions options;
  options.force_drift_units = 2.0;  // it was seen to wander
  LateSamples samples(options, kTissueGain);
  const Eigen::Matrix3d seen_m2 = 4e-8 * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d bias_m(0.001, -0.002, 0.001);  // of their port: the same then and now
  for (int i = 0; i < 40; ++i) {
    samples.Note(WristOnly(i));
    const Eigen::Vector3d p = i < 35 ? TrueTip(i).p : free.Solve(WristAt(i)).T_RE().p;
    samples.NoteTipBySensors(kStart_ns + i * kPeriod_ns, p + bias_m, seen_m2);
  }
  SensorReadings now = WristOnly(39);
  now.tip = Tip(now.wrist->t_ns - 20 * kPeriod_ns, TrueTip(19));
  ASSERT_TRUE(samples.Carry(model_, now));
  const Eigen::Vector3d truth = free.Solve(WristAt(39)).T_RE().p;
  EXPECT_GT((truth - TrueTip(39).p).norm(), 0.002);
  EXPECT_LT((now.tip->value.tip.p_RE - truth).norm(), 0.0003);
}

TEST(ReadingsHistory, InterpolatesEachSensorByItsOwnTimes) {
  ReadingsHistory history;
  for (int i = 0; i < 400; ++i) {
    SensorReadings readings = WristOnly(i);
    readings.load = {readings.wrist->t_ns - 3 * kPeriod_ns, {{0.1 * i, 0.0, 0.0}, 0.01}};
    history.Add(readings);
  }
  const TimeNs t_ns = kStart_ns + 350 * kPeriod_ns + kPeriod_ns / 4;
  const auto then = history.At(t_ns);
  ASSERT_TRUE(then);
  EXPECT_LT((then->wrist->value.p_RW - (0.75 * WristAt(350) + 0.25 * WristAt(351))).norm(), 1e-9);
  EXPECT_NEAR(then->load->value.f_tip_N.x(), 0.1 * 353.25, 1e-6);
  EXPECT_FALSE(history.At(kStart_ns));  // 256 are kept
  const Eigen::Vector3d v = history.WristVelocityAt(t_ns);
  const Eigen::Vector3d expected =
      (WristAt(352) - WristAt(349)) / (3e-9 * static_cast<double>(kPeriod_ns));
  EXPECT_LT((v - expected).norm(), 5e-3 * expected.norm());
}

// A step at a random moment between two samples: what its place scatters by about the line.
TEST(ReadingsHistory, DoubtsTheWristBetweenTwoSamples) {
  ReadingsHistory history;
  for (int i = 0; i < 20; ++i) history.Add(WristOnly(i));
  EXPECT_EQ(history.WristDoubtAt(kStart_ns + 10 * kPeriod_ns), Eigen::Vector3d::Zero());
  EXPECT_EQ(history.WristDoubtAt(kStart_ns + 25 * kPeriod_ns), Eigen::Vector3d::Zero());
  for (const double u : {0.1, 0.5, 0.8}) {
    const Eigen::Vector3d a = WristAt(10), b = WristAt(11);
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    constexpr int kSteps = 10'000;
    for (int i = 0; i < kSteps; ++i) {
      const double when = (i + 0.5) / kSteps;
      const Eigen::Vector3d off = (when < u ? b : a) - ((1.0 - u) * a + u * b);
      scatter += off * off.transpose() / kSteps;
    }
    const TimeNs t_ns =
        kStart_ns + 10 * kPeriod_ns + std::llround(u * static_cast<double>(kPeriod_ns));
    const Eigen::Vector3d doubt = history.WristDoubtAt(t_ns);
    EXPECT_LT((doubt * doubt.transpose() - scatter).norm(), 1e-3 * scatter.norm()) << u;
  }
}

TEST(ReadingsHistory, KeepsTheNewestOfAFastCycle) {
  ReadingsHistory history;
  constexpr TimeNs kFast_ns = 1'000'000;
  for (int i = 0; i < 2000; ++i) {
    SensorReadings readings;
    readings.wrist = {kStart_ns + i * kFast_ns, {Eigen::Vector3d(1e-6 * i * i, 0, 0), {}, 0, 0}};
    history.Add(readings);
    if (i == 0) continue;
    ASSERT_NEAR(history.WristAt(readings.wrist->t_ns)->p_RW.x(), 1e-6 * i * i, 1e-12) << i;
  }
  // A parabola between samples 4 ms apart is off by a quarter of 4^2 at most.
  const TimeNs second_ns = 1'000'000'000;
  const auto wrist = history.WristAt(kStart_ns + 1999 * kFast_ns - second_ns);
  ASSERT_TRUE(wrist);
  EXPECT_NEAR(wrist->p_RW.x(), 1e-6 * 999 * 999, 4.1e-6);
}

}  // namespace
}  // namespace flextip
