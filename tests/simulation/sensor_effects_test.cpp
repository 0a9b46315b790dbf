// What sensors do beyond their data sheets, against closed formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/derivative_check.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/camera_view.h"
#include "simulation/sensors/sensors.h"

namespace flextip::simulation {
namespace {

Eigen::Vector3d RandomVector(std::mt19937_64& rng, double size) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return size * Eigen::Vector3d(x, y, z).normalized();
}

Eigen::Matrix3d SomeGradient() {
  Eigen::Matrix3d gradient;
  gradient << 0.01, -0.004, 0.002, 0.007, -0.012, 0.003, -0.001, 0.006, 0.015;
  return gradient;
}

TEST(EmField, LinearPartIsTheGradient) {
  const Eigen::Vector3d centre(0.2, -0.1, 0.05);
  const EmField field(SomeGradient(), centre, 0.2);
  EXPECT_EQ(field.Bias(centre).norm(), 0.0);
  const auto bias = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd { return field.Bias(p); };
  EXPECT_LT((NumericJacobian(bias, centre, 1e-3) - SomeGradient()).norm(), 1e-8);
}

TEST(EmField, RestIsAStatedPartAtATenthOfAMetre) {
  const Eigen::Vector3d centre(0.2, -0.1, 0.05);
  const EmField field(SomeGradient(), centre, 0.15);
  std::mt19937_64 rng(3);
  double rest = 0.0, linear = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d offset = RandomVector(rng, 0.1);
    const Eigen::Vector3d straight = SomeGradient() * offset;
    rest += (field.Bias(centre + offset) - straight).squaredNorm();
    linear += straight.squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(rest / linear), 0.15, 0.004);
}

TEST(EmField, RestIsOfSecondOrder) {
  const EmField field(SomeGradient(), Eigen::Vector3d::Zero(), 0.2);
  const Eigen::Vector3d way = Eigen::Vector3d(1, 2, -1).normalized();
  const auto rest = [&](double d) {
    return (field.Bias(d * way) - SomeGradient() * (d * way)).norm();
  };
  EXPECT_NEAR(rest(0.002) / rest(0.001), 4.0, 0.05);
}

TEST(EmField, NoGradientNoBias) {
  EXPECT_EQ(EmField(Eigen::Matrix3d::Zero(), {0.1, 0, 0}, 0.2).Bias({1, 2, 3}).norm(), 0.0);
}

class SeenTipTest : public testing::Test {
 protected:
  Pose T_RE_{ExpRotation({0.2, 0.5, -0.3}), {0.25, 0.02, -0.03}};
  Pose T_RC_{ExpRotation({0.3, -1.1, 0.4}), {0.12, 0.05, 0.14}};
};

TEST_F(SeenTipTest, TruthWithoutEffects) {
  const Pose seen = SeenTip(T_RE_, T_RC_, {});
  EXPECT_LT((seen.p - T_RE_.p).norm(), 1e-15);
  EXPECT_LT((seen.R - T_RE_.R).norm(), 1e-14);
}

TEST_F(SeenTipTest, TagOffsetIsInTheTipFrame) {
  SensorEffects effects;
  effects.tag_offset_m = {0.001, -0.002, 0.003};
  const Eigen::Vector3d expected =
      T_RE_.p + 0.001 * T_RE_.R.col(0) - 0.002 * T_RE_.R.col(1) + 0.003 * T_RE_.R.col(2);
  EXPECT_LT((SeenTip(T_RE_, T_RC_, effects).p - expected).norm(), 1e-15);
}

TEST_F(SeenTipTest, HandEyeTurnsBackAboutTheCamera) {
  SensorEffects effects;
  const Eigen::Vector3d turn(1e-5, -2e-5, 3e-5), shift(2e-6, 1e-6, -3e-6);
  effects.hand_eye_rotation_rad = turn;
  effects.hand_eye_translation_m = shift;
  const Pose seen = SeenTip(T_RE_, T_RC_, effects);
  // To first order the tip seems moved by what undoes the camera's own move.
  const Eigen::Vector3d expected = T_RE_.p - shift - turn.cross(T_RE_.p - T_RC_.p);
  EXPECT_LT((seen.p - expected).norm(), 1e-9);
  EXPECT_GT((seen.p - T_RE_.p).norm(), 3e-6);
  EXPECT_LT((LogRotation(seen.R * T_RE_.R.transpose()) + turn).norm(), 1e-8);
}

TEST_F(SeenTipTest, FocalLengthScalesDepth) {
  for (const double scale : {0.9, 0.98, 1.0001, 1.05, 1.1}) {
    SensorEffects effects;
    effects.focal_scale = scale;
    const double off = std::abs(scale - 1.0);
    const auto seen = [&](const Eigen::Vector3d& p_C) -> Eigen::Vector3d {
      return T_RC_.Inverse() * SeenTip({T_RE_.R, T_RC_ * p_C}, T_RC_, effects).p;
    };
    const Eigen::Vector3d ahead = seen({0.0, 0.0, 0.2});
    EXPECT_NEAR(ahead.z(), 0.2 / scale, 0.002 * off) << scale;
    EXPECT_LT(ahead.head<2>().norm(), 2e-4 * off) << scale;
    // Aside, the collar seems turned too, which costs 3 % of the change at 13 degrees.
    const Eigen::Vector3d aside = seen({0.05, -0.03, 0.25});
    EXPECT_NEAR(aside.z(), 0.25 / scale, 0.03 * 0.25 * off) << scale;
    EXPECT_LT((aside.head<2>() - Eigen::Vector2d(0.05, -0.03)).norm(), 0.03 * 0.06 * off) << scale;
  }
}

TEST_F(SeenTipTest, FocalLengthLeavesTheProjectionOfTheTipAlone) {
  SensorEffects effects;
  effects.focal_scale = 1.06;
  const Eigen::Vector3d p_C(0.03, 0.02, 0.22);
  const Pose T_RE{T_RE_.R, T_RC_ * p_C};
  const Eigen::Vector3d seen_C = T_RC_.Inverse() * SeenTip(T_RE, T_RC_, effects).p;
  // The image is what it is: 1.06 X / Z of the truth is X / Z of what is reported.
  EXPECT_NEAR(seen_C.x() / seen_C.z(), 1.06 * p_C.x() / p_C.z(), 5e-5);
  EXPECT_NEAR(seen_C.y() / seen_C.z(), 1.06 * p_C.y() / p_C.z(), 5e-5);
}

/// A loaded shaft whose wrist swings.
class SensorsTest : public testing::Test {
 protected:
  SensorsTest() {
    plant_.instrument = {0.5, 0.0025, 0.3, 0.0};
    plant_.p_RP = {0.2, 0.0, 0.0};
    plant_.load.constant_N = {0.0, 0.3, -0.5};
    setup_.wrist = WristStream{"", 50.0, 5e-5, 3e-4, {}};
    setup_.em0.emplace();
    setup_.em0->rate_hz = 50.0;
    setup_.em0->distance_from_tip_m = 0.02;
    setup_.em0->position_noise_m = 1.3e-4;
    setup_.em0->orientation_noise_rad = 5.6e-4;
    setup_.strain = StrainStream{"", 50.0, {0.1, 0.4}, 8e-4, {}};
    setup_.tip.emplace();
    setup_.tip->rate_hz = 25.0;
  }

  static Eigen::Vector3d Wrist(double t_s) {
    return {0.03 * std::sin(2.1 * t_s), 0.04 * std::sin(3.0 * t_s + 0.4),
            0.05 * std::cos(2.6 * t_s)};
  }
  PlantShape At(double t_s) const { return Plant(plant_, {30, 30}).Solve(Wrist(t_s)); }

  Recording Swing(const SensorEffects& effects, double duration_s = 1.0) const {
    Sensors sensors(setup_, 5, effects);
    Recording recording;
    Plant plant(plant_, {30, 30});
    for (int tick = -20; tick < std::lround(100 * duration_s); ++tick) {
      sensors.Sample(plant.Solve(Wrist(0.01 * tick)), kSimulationStart_ns + 10'000'000LL * tick,
                     recording);
    }
    return recording;
  }

  /// The same shape again and again.
  Recording Stand(const SensorEffects& effects, int samples) const {
    Sensors sensors(setup_, 5, effects);
    Recording recording;
    const PlantShape shape = At(0.0);
    for (int i = 0; i < samples; ++i) {
      sensors.Sample(shape, kSimulationStart_ns + 20'000'000LL * i, recording);
    }
    return recording;
  }

  PlantSetup plant_;
  SensorSetup setup_;
};

SensorEffects Quiet() {
  SensorEffects effects;
  effects.noise_scale = 0.0;
  return effects;
}

TEST_F(SensorsTest, LateSamplesShowThePast) {
  SensorEffects effects = Quiet();
  effects.em_latency_s = 0.0373;
  effects.camera_latency_s = 0.0641;
  const Recording recording = Swing(effects);
  ASSERT_EQ(recording.em0->samples.size(), 50u);
  ASSERT_EQ(recording.vision0->tips.size(), 25u);
  for (int i = 0; i < 50; i += 7) {
    const Pose past = At(0.02 * i - 0.0373).Frame(0.48);
    const EmSample& seen = recording.em0->samples[i].value;
    EXPECT_LT((seen.p_RS - past.p).norm(), 1e-6) << i;
    EXPECT_LT(seen.q_RS.angularDistance(past.Quaternion()), 1e-5) << i;
    EXPECT_GT((seen.p_RS - At(0.02 * i).Frame(0.48).p).norm(), 1e-4) << i;
  }
  for (int i = 0; i < 25; i += 4) {
    const Pose past = At(0.04 * i - 0.0641).T_RE();
    EXPECT_LT((recording.vision0->tips[i].value.p_RE - past.p).norm(), 1e-6) << i;
    EXPECT_LT((*recording.vision0->tips[i].value.d_RE - past.R.col(0)).norm(), 1e-5) << i;
  }
  // Encoders and gages are on time.
  EXPECT_LT((recording.wrist0->samples[30].value.p_RW - Wrist(0.6)).norm(), 1e-12);
}

TEST_F(SensorsTest, GagesScaleDriftAndClip) {
  const Recording clean = Swing(Quiet(), 4.0);
  SensorEffects effects = Quiet();
  effects.strain_gain = {1.1, 0.8, 1.0, 0.95};
  effects.strain_drift_Nm_s = {1e-3, 0.0, -5e-4, 2e-3};
  const Recording off = Swing(effects, 4.0);
  effects.strain_limit_Nm = 0.05;
  const Recording clipped = Swing(effects, 4.0);
  bool some_clipped = false;
  for (std::size_t i = 0; i < clean.strain0->moments_Nm.size(); ++i) {
    const double t = 0.02 * static_cast<double>(i);
    for (int gage = 0; gage < 4; ++gage) {
      const double expected = effects.strain_gain[gage] * clean.strain0->moments_Nm[i].value[gage] +
                              t * effects.strain_drift_Nm_s[gage];
      EXPECT_NEAR(off.strain0->moments_Nm[i].value[gage], expected, 1e-12);
      EXPECT_NEAR(clipped.strain0->moments_Nm[i].value[gage],
                  std::min(0.05, std::max(-0.05, expected)), 1e-12);
      some_clipped |= std::abs(expected) > 0.05;
    }
  }
  EXPECT_TRUE(some_clipped);
}

TEST_F(SensorsTest, EmBiasAtTheTruePlace) {
  SensorEffects effects = Quiet();
  const Recording clean = Swing(effects);
  effects.em_gradient = SomeGradient();
  effects.em_centre_m = {0.4, 0.0, 0.0};
  effects.em_curvature = 0.2;
  const Recording bent = Swing(effects);
  const EmField field(effects.em_gradient, effects.em_centre_m, effects.em_curvature);
  for (std::size_t i = 0; i < 50; ++i) {
    const Eigen::Vector3d p = clean.em0->samples[i].value.p_RS;
    EXPECT_LT((bent.em0->samples[i].value.p_RS - p - field.Bias(p)).norm(), 1e-14);
    EXPECT_EQ(bent.em0->samples[i].value.q_RS, clean.em0->samples[i].value.q_RS);
  }
}

struct Moments {
  double sd = 0.0, lag1 = 0.0;
};

/// Of the wrist's x, the moments' first gage and the EM sensor's z.
template <class Get>
Moments MomentsOf(int count, const Get& get) {
  double mean = 0.0, square = 0.0, product = 0.0;
  for (int i = 0; i < count; ++i) mean += get(i) / count;
  for (int i = 0; i < count; ++i) {
    const double x = get(i) - mean;
    square += x * x;
    if (i > 0) product += x * (get(i - 1) - mean);
  }
  return {std::sqrt(square / count), product / square};
}

TEST_F(SensorsTest, NoiseHasStatedLevelScaleAndCorrelation) {
  constexpr int kCount = 6000;
  for (const double correlation : {0.0, 0.6}) {
    SensorEffects effects;
    effects.noise_scale = 1.5;
    effects.noise_correlation = correlation;
    const Recording r = Stand(effects, kCount);
    const Moments wrist =
        MomentsOf(kCount, [&](int i) { return r.wrist0->samples[i].value.p_RW.x(); });
    const Moments em = MomentsOf(kCount, [&](int i) { return r.em0->samples[i].value.p_RS.z(); });
    const Moments gage =
        MomentsOf(kCount, [&](int i) { return r.strain0->moments_Nm[i].value[3]; });
    // Standard errors: sd sqrt((1 + a^2) / (1 - a^2) / 2n), correlation sqrt((1 - a^2) / n).
    const double sd_error = std::sqrt((1 + correlation * correlation) /
                                      (1 - correlation * correlation) / (2.0 * kCount));
    EXPECT_NEAR(wrist.sd / 7.5e-5, 1.0, 4 * sd_error);
    EXPECT_NEAR(em.sd / 1.95e-4, 1.0, 4 * sd_error);
    EXPECT_NEAR(gage.sd / 1.2e-3, 1.0, 4 * sd_error);
    for (const Moments& m : {wrist, em, gage}) EXPECT_NEAR(m.lag1, correlation, 0.06);
  }
}

TEST_F(SensorsTest, TipNoiseIsTheStatedCovariance) {
  setup_.tip->across_noise_m = 8e-5;
  setup_.tip->depth_noise_m = 3e-4;
  setup_.tip->line_of_sight = Eigen::Vector3d(0.47, -0.16, -0.87).normalized();
  const Recording r = Stand({}, 8000);
  const Eigen::Vector3d truth = At(0.0).T_RE().p;
  const auto& tips = r.vision0->tips;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& tip : tips) {
    covariance += (tip.value.p_RE - truth) * (tip.value.p_RE - truth).transpose();
  }
  covariance /= static_cast<double>(tips.size());
  const Eigen::Matrix3d root = Llt(tips[0].value.covariance_m2).L();
  const Eigen::Matrix3d whitened = root.inverse() * covariance * root.inverse().transpose();
  EXPECT_LT((whitened - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
            4.5 * std::sqrt(2.0 / static_cast<double>(tips.size())));
}

}  // namespace
}  // namespace flextip::simulation
