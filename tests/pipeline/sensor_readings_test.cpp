#include "pipeline/sensor_readings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/rotation.h"

namespace flextip {
namespace {

/// Every stream, two samples 100 ms apart; the tip's own frames at 50 and 100 ms.
Recording Small() {
  Recording r;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  r.wrist0 = WristStream{"", 10.0, 1e-4, 2e-4, {}};
  r.wrist0->samples = {{0, {{0, 0, 0}, q}}, {100'000'000, {{1, 2, 3}, q}}};
  r.em0 = EmStream{"", 10.0, 0.02, 3e-4, 4e-4, NoiseDistribution::kGaussian, 3e-3, 4e-3, {}};
  r.em0->samples = {{0, {{1, 0, 0}, q}}, {100'000'000, {{3, 0, 0}, q}}};
  r.em1 = r.em0;
  r.strain0 = StrainStream{"", 10.0, {0.1, 0.4}, 5e-4, {}};
  r.strain0->moments_Nm = {{0, {1, 2, 3, 4}}, {100'000'000, {3, 4, 5, 6}}};
  r.load0 = LoadStream{"", 10.0, 6e-3, {}};
  r.load0->f_tip_N = {{0, {1, 1, 1}}, {100'000'000, {2, 2, 2}}};
  r.vision0.emplace();
  r.vision0->rate_hz = 20.0;
  r.vision0->direction_noise_rad = 3e-3;
  r.vision0->registration_noise_rad = 4e-3;
  r.vision0->registration_noise_m = 1e-3;
  const TipObservation tip{TipStatus::kOk, {7, 8, 9}, 1e-6 * Eigen::Matrix3d::Identity(), {}};
  r.vision0->tips = {{50'000'000, tip}, {100'000'000, tip}};
  return r;
}

TEST(SensorReadings, AreInterpolatedAtATimeOfARecording) {
  const Recording r = Small();
  const auto z = MeasurementsAt(r, 50'000'000);
  ASSERT_TRUE(z);
  EXPECT_LT((z->p_RW - Eigen::Vector3d(0.5, 1.0, 1.5)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(z->wrist_position_noise_m, 1e-4);
  EXPECT_DOUBLE_EQ(z->wrist_orientation_noise_rad, 2e-4);
  EXPECT_LT((z->em->T_RS.p - Eigen::Vector3d(2, 0, 0)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(z->em->distance_from_tip_m, 0.02);
  EXPECT_LT((z->strain->moments_Nm - Eigen::Vector4d(2, 3, 4, 5)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(z->strain->station_from_wrist_m[1], 0.4);
  EXPECT_LT((z->load->f_tip_N - Eigen::Vector3d::Constant(1.5)).norm(), 1e-12);
  EXPECT_LT((*z->port_direction - Eigen::Vector3d(std::cos(0.3), std::sin(0.3), 0)).norm(), 1e-12);
  EXPECT_EQ(z->tip->p_RE, Eigen::Vector3d(7, 8, 9));
}

TEST(SensorReadings, ARegistrationAddsToTheNoise) {
  const auto z = MeasurementsAt(Small(), 50'000'000);
  ASSERT_TRUE(z);
  EXPECT_NEAR(z->em->position_noise_m, std::hypot(3e-4, 4e-3), 1e-15);
  EXPECT_NEAR(z->em->orientation_noise_rad, std::hypot(4e-4, 3e-3), 1e-15);
  EXPECT_NEAR(z->port_direction_noise_rad, std::hypot(4e-4, 3e-3), 1e-15);
  EXPECT_NEAR(z->tip_direction_noise_rad, 5e-3, 1e-15);
  EXPECT_NEAR(z->tip->covariance_m2(1, 1), 2e-6, 1e-18);
}

TEST(SensorReadings, AClocksDeviationEntersByTheSpeed) {
  Recording r = Small();
  r.vision0->tips[1].value.p_RE += Eigen::Vector3d(0.01, 0.0, 0.0);          // 0.2 m/s along x
  r.em0->clock.covariance(0, 0) = r.vision0->clock.covariance(0, 0) = 4e-6;  // 2 ms
  r.em0->clock.covariance(1, 1) = 1e-4;                                      // and 1 % of 50 ms
  const auto z = MeasurementsAt(r, 50'000'000), before = MeasurementsAt(Small(), 50'000'000);
  ASSERT_TRUE(z && before);
  Eigen::Matrix3d more = z->tip->covariance_m2 - before->tip->covariance_m2;
  EXPECT_NEAR(more(0, 0), 4e-4 * 4e-4, 1e-12);
  more(0, 0) = 0.0;
  EXPECT_LT(more.norm(), 1e-15);
  const double em_m = 20.0 * std::hypot(0.002, 0.01 * 0.05);  // em0 moves by 20 m/s
  EXPECT_NEAR(z->em->position_noise_m,
              std::hypot(before->em->position_noise_m, em_m / std::sqrt(3.0)), 1e-12);
}

TEST(SensorReadings, ALostTipHasNoSpeed) {
  Recording r = Small();
  r.vision0->clock.covariance(0, 0) = 4e-6;
  r.vision0->tips[1].value.status = TipStatus::kLost;
  r.vision0->tips[1].value.p_RE.setConstant(1e3);
  EXPECT_EQ(MeasurementsAt(r, 50'000'000)->tip->covariance_m2,
            MeasurementsAt(Small(), 50'000'000)->tip->covariance_m2);
}

TEST(SensorReadings, TheTipCountsAtItsOwnFramesOnly) {
  EXPECT_FALSE(MeasurementsAt(Small(), 60'000'000)->tip);
  Recording lost = Small();
  lost.vision0->tips.front().value.status = TipStatus::kLost;
  EXPECT_FALSE(MeasurementsAt(lost, 50'000'000)->tip);
}

TEST(SensorReadings, NothingIsKnownWithoutTheWrist) {
  Recording r = Small();
  EXPECT_FALSE(MeasurementsAt(r, 200'000'000'000));
  r.wrist0.reset();
  EXPECT_FALSE(MeasurementsAt(r, 50'000'000));
  EXPECT_FALSE(Gather(NewestReadings(r)));
}

// Both ways to the readings end in one: at the time of the last samples they say the same.
TEST(SensorReadings, TheNewestAreThoseAtTheLastTime) {
  const Recording r = Small();
  const SensorReadings newest = NewestReadings(r), there = ReadingsAt(r, 100'000'000);
  EXPECT_EQ(newest.wrist->t_ns, 100'000'000);
  const auto a = Gather(newest), b = Gather(there);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->p_RW, b->p_RW);
  EXPECT_EQ(*a->R_RW, *b->R_RW);
  EXPECT_EQ(a->em->T_RS.p, b->em->T_RS.p);
  EXPECT_EQ(a->em->position_noise_m, b->em->position_noise_m);
  EXPECT_EQ(*a->port_direction, *b->port_direction);
  EXPECT_EQ(a->strain->moments_Nm, b->strain->moments_Nm);
  EXPECT_EQ(a->load->f_tip_N, b->load->f_tip_N);
  EXPECT_EQ(a->tip->p_RE, b->tip->p_RE);
  EXPECT_EQ(a->tip->covariance_m2, b->tip->covariance_m2);
}

}  // namespace
}  // namespace flextip
