// What gages, clocks, encoders, load cell, lens and scope misread, against closed formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/rotation.h"
#include "simulation/plant/plant.h"
#include "simulation/plant/wrist_reading.h"
#include "simulation/sensors/camera_view.h"
#include "simulation/sensors/sensors.h"

namespace flextip::simulation {
namespace {

constexpr double kTick_s = 0.02;

/// A loaded shaft that stands, without noise.
class Misreading : public testing::Test {
 protected:
  Misreading() {
    PlantSetup plant;
    plant.instrument = {0.5, 0.0025, 0.3, 0.0};
    plant.p_RP = {0.2, 0.0, 0.0};
    plant.load.constant_N = {0.1, 0.3, -0.5};
    shape_ = Plant(plant, {30, 30}).Solve({0.01, 0.02, -0.01});
    setup_.em0.emplace();
    setup_.em0->rate_hz = 50.0;
    setup_.em0->distance_from_tip_m = 0.02;
    setup_.strain = StrainStream{"", 50.0, {0.1, 0.4}, 8e-4, {}};
    setup_.load.emplace();
    setup_.load->rate_hz = 50.0;
    setup_.tip.emplace();
    setup_.tip->rate_hz = 50.0;
    setup_.tip->T_RC = {ExpRotation({0.3, -1.1, 0.4}), {0.32, 0.05, 0.14}};
    effects_.noise_scale = 0.0;
  }

  Recording Stand(int samples = 2) const {
    Sensors sensors(setup_, 5, effects_);
    Recording recording;
    for (int i = 0; i < samples; ++i)
      sensors.Sample(shape_, kSimulationStart_ns + std::llround(1e9 * kTick_s * i), recording);
    return recording;
  }
  Eigen::Vector4d Gages() const { return Stand().strain0->moments_Nm[0].value; }

  PlantShape shape_;
  SensorSetup setup_;
  SensorEffects effects_;
};

TEST_F(Misreading, TurnedGagesReadTheMomentTurnedBack) {
  const Eigen::Vector4d straight = Gages();
  effects_.gage_rotation_rad = 0.2;
  const Eigen::Vector4d turned = Gages();
  const Eigen::Matrix2d back = Eigen::Rotation2Dd(-0.2).toRotationMatrix();
  for (int station = 0; station < 2; ++station) {
    const Eigen::Vector2d expected = back * straight.segment<2>(2 * station);
    EXPECT_LT((turned.segment<2>(2 * station) - expected).norm(), 1e-15);
    EXPECT_GT((turned - straight).segment<2>(2 * station).norm(), 1e-3);
  }
}

TEST_F(Misreading, AGageReadsPartOfAnothers) {
  const Eigen::Vector4d alone = Gages();
  effects_.strain_crosstalk(1, 2) = 0.3;
  effects_.strain_gain[1] = 0.9;
  EXPECT_NEAR(Gages()[1], 0.9 * alone[1] + 0.3 * alone[2], 1e-15);
  EXPECT_EQ(Gages()[2], alone[2]);
}

TEST_F(Misreading, ALoadCellIsScaledAndAskew) {
  effects_.load_scale = 1.2;
  effects_.load_rotation_rad = {0.0, 0.0, 0.5 * std::numbers::pi};
  const Eigen::Vector3d read = Stand().load0->f_tip_N[0].value;
  EXPECT_LT((read - 1.2 * Eigen::Vector3d(-0.3, 0.1, -0.5)).norm(), 1e-12);
}

TEST_F(Misreading, AClockOfItsOwnStampsWhatIsTakenLater) {
  effects_.em_clock_rate = 0.01;
  effects_.camera_clock_rate = -0.02;
  const Recording recording = Stand(60);
  const auto since = [](TimeNs t_ns) { return 1e-9 * double(t_ns - kSimulationStart_ns); };
  for (const int i : {0, 17, 59}) {
    // What is stamped t was taken at t + rate t.
    EXPECT_NEAR(1.01 * since(recording.em0->samples[i].t_ns), kTick_s * i, 2e-9);
    EXPECT_NEAR(0.98 * since(recording.vision0->tips[i].t_ns), kTick_s * i, 2e-9);
    EXPECT_EQ(recording.strain0->moments_Nm[i].t_ns,
              kSimulationStart_ns + std::llround(1e9 * kTick_s * i));
  }
}

TEST_F(Misreading, AMotorSwingsTheEmPosition) {
  const Eigen::Vector3d still = Stand().em0->samples[0].value.p_RS;
  effects_.em_interference = {{0.001, -0.002, 0.0005}, 3.0, 0.4};
  const Recording recording = Stand(60);
  for (const int i : {0, 3, 41}) {
    const double swing = std::sin(2.0 * std::numbers::pi * 3.0 * kTick_s * i + 0.4);
    const Eigen::Vector3d expected = still + swing * Eigen::Vector3d(0.001, -0.002, 0.0005);
    EXPECT_LT((recording.em0->samples[i].value.p_RS - expected).norm(), 1e-12) << i;
  }
}

TEST_F(Misreading, AScopeThatSinksIsAHandEyeThatGrows) {
  const Eigen::Vector3d turn(1e-3, -2e-3, 5e-4), shift(1e-4, 2e-4, -3e-4);
  effects_.camera_drift_rad_s = turn;
  effects_.camera_drift_m_s = shift;
  const Recording recording = Stand(101);
  SensorEffects off;
  off.hand_eye_rotation_rad = 2.0 * turn;
  off.hand_eye_translation_m = 2.0 * shift;
  const Pose expected = SeenTip(shape_.T_RE(), setup_.tip->T_RC, off);
  EXPECT_LT((recording.vision0->tips[100].value.p_RE - expected.p).norm(), 1e-12);
  EXPECT_LT((recording.vision0->tips[0].value.p_RE - shape_.T_RE().p).norm(), 1e-12);
}

TEST_F(Misreading, ALensDisplacesWhatIsOffItsAxis) {
  constexpr double kK1 = 0.1;
  effects_.lens_k1 = kK1;
  const Pose& T_RC = setup_.tip->T_RC;
  const auto seen = [&](const Eigen::Vector3d& p_C) -> Eigen::Vector3d {
    return T_RC.Inverse() * SeenTip({shape_.T_RE().R, T_RC * p_C}, T_RC, effects_).p;
  };
  // The middle of the collar's image, to the collar's size over its distance.
  const Eigen::Vector3d aside(0.05, -0.03, 0.25), off = seen(aside);
  const double r2 = (aside.head<2>() / aside.z()).squaredNorm();
  const Eigen::Vector2d displaced = (1.0 + kK1 * r2) * aside.head<2>() / aside.z();
  EXPECT_LT((off.head<2>() / off.z() - displaced).norm(), 1e-3 * displaced.norm());
  EXPECT_GT((off.head<2>() / off.z() - aside.head<2>() / aside.z()).norm(),
            4e-3 * displaced.norm());
  EXPECT_LT(off.z(), aside.z());  // the tags look larger, so nearer
  // But for the corners of the collar: 6 and 5 mm off it, they look larger, and it nearer, by twice
  // k1 r^2 at most.
  const double corner2 = (0.006 * 0.006 + 0.005 * 0.005) / (0.25 * 0.25);
  EXPECT_LT((seen({0.0, 0.0, 0.25}) - Eigen::Vector3d(0.0, 0.0, 0.25)).norm(),
            2.0 * kK1 * corner2 * 0.25);
}

TEST(WristReading, IsAGearRatioAndASineOfTheDistanceToThePort) {
  const Eigen::Vector3d about(0.01, 0.0, 0.02), p_RP(0.3, 0.0, 0.0), p_RW(0.05, 0.02, -0.01);
  WristReading reading;
  reading.scale = 1.02;
  EXPECT_LT((MeasuredWrist(p_RW, about, p_RP, reading) - (about + 1.02 * (p_RW - about))).norm(),
            1e-15);
  reading = {.eccentricity_m = 0.001, .wavelength_m = 0.02, .phase_rad = 0.3};
  const Eigen::Vector3d off = MeasuredWrist(p_RW, about, p_RP, reading) - p_RW;
  const double distance_m = (p_RP - p_RW).norm();
  const double expected_m = 0.001 * std::sin(2.0 * std::numbers::pi * distance_m / 0.02 + 0.3);
  EXPECT_NEAR(off.dot((p_RP - p_RW).normalized()), expected_m, 1e-15);
  EXPECT_NEAR(off.norm(), std::abs(expected_m), 1e-15);
}

TEST(WristReading, IsUndone) {
  const Eigen::Vector3d about(0.01, 0.0, 0.02), p_RP(0.3, 0.0, 0.0);
  const WristReading reading{.scale = 0.97, .eccentricity_m = 0.0015, .wavelength_m = 0.015};
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p_RW(0.002 * i, 0.03 * std::sin(i), 0.03 * std::cos(2 * i));
    const Eigen::Vector3d measured = MeasuredWrist(p_RW, about, p_RP, reading);
    EXPECT_LT((WristOfReading(measured, about, p_RP, reading) - p_RW).norm(), 1e-10);
  }
}

TEST(WristReading, ThePlantIsWhereItTrulyIs) {
  PlantSetup setup;
  setup.instrument = {0.5, 0.0025, 0.3, 0.0};
  setup.p_RP = {0.2, 0.0, 0.0};
  setup.effects.wrist_reading.scale = 1.05;
  Plant plant(setup, {30, 30});
  const Eigen::Vector3d first(0.0, 0.0, 0.0), then(0.02, 0.01, 0.0);
  plant.Solve(first, 0.0);
  const PlantShape shape = plant.Solve(then, 0.1);
  EXPECT_LT((shape.T_RW().p - then / 1.05).norm(), 1e-12);
  EXPECT_EQ(shape.p_RW_measured, then);
}

}  // namespace
}  // namespace flextip::simulation
