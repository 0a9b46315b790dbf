// EM calibration against known registrations and fields, by Monte Carlo.
#include "calibration/em/em_calibration.h"

#include <gmock/gmock.h>

#include <random>

#include "core/draw_vector.h"
#include "core/error.h"
#include "core/linear_algebra.h"
#include "tests/calibration/em_scene.h"

namespace flextip {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;

EmOptions OptionsOf(const EmScene& scene) { return {.distance_from_tip_m = scene.distance_m}; }

bool HasField(const EmResult& result) { return result.design.basis.kind != FieldKind::kNone; }

/// Truth less estimate, as calibration.yaml counts it.
Vector7d ErrorOf(const EmResult& result, const EmScene& scene) {
  Vector7d e;
  e << LogRotation(scene.T_RF.R * result.solution.T_RF.R.transpose()),
      scene.T_RF.p - result.solution.T_RF.p, scene.distance_m - result.solution.distance_m;
  return e;
}

/// Bends as metal beside the volume would: some 5 mm at its rim.
EmScene Metal() {
  EmScene scene;
  scene.pairs = 900;
  scene.corrected = [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d u = (p - Eigen::Vector3d(0.46, 0, 0)) / 0.1;
    return p + 2.5e-3 * Eigen::Vector3d(0.8 * u.x() * u.y() + 1.5 * u.z() * u.z(),
                                        1.2 * u.x() - 0.9 * u.y() * u.y(),
                                        1.2 * u.z() * u.y() - 1.1 * u.x() * u.x());
  };
  return scene;
}

double RmsError(const EmResult& result, const EmScene& scene, unsigned seed) {
  EmScene clean = scene;
  clean.em_noise_m = clean.reference_noise_m = 0;
  clean.pairs = 300;
  std::mt19937 random(seed);
  double sum = 0;
  for (EmPair pair : DrawEm(clean, random)) {
    EmSolution at = result.solution;
    sum += EmError(pair, at).squaredNorm() / (3 * clean.pairs);
  }
  return std::sqrt(sum);
}

// Whatever the rounding errors are: their parts of space differ as little as the whole does.
TEST(EmCalibration, IsExactWithoutNoise) {
  EmScene scene;
  scene.em_true = 0;
  scene.reference_noise_m = 0;
  scene.lean_rad = 0.1;
  EmOptions options = OptionsOf(scene);
  options.distance_from_tip_m = 0.04;  // as the recording has it wrongly
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const EmResult result = CalibrateEm(DrawEm(scene, random), options);
    ASSERT_EQ(result.status, EmStatus::kOk) << result.message;
    EXPECT_LT(ErrorOf(result, scene).norm(), 1e-8) << seed;
    EXPECT_FALSE(HasField(result)) << seed;
    EXPECT_LT(result.angle_rms_rad, 1e-6) << seed;
  }
}

// 300 draws with the sensor's noise stated wrongly: registration and distance together.
TEST(EmCalibration, CovarianceIsHonest) {
  EmScene scene;
  scene.pairs = 150;
  scene.em_true = 1.7;
  std::mt19937 random(2);
  constexpr int kDraws = 300;
  double sum = 0;
  int fields = 0;
  for (int i = 0; i < kDraws; ++i) {
    EmOptions options = OptionsOf(scene);
    options.max_distance_sd_m = 0.01;
    const EmResult result = CalibrateEm(DrawEm(scene, random), options);
    ASSERT_EQ(result.status, EmStatus::kOk);
    if (HasField(result)) {
      ++fields;
      continue;
    }
    ASSERT_TRUE(result.design.free_distance);
    const Vector7d e = ErrorOf(result, scene);
    sum += MahalanobisSquared(e, result.solution.covariance);
  }
  EXPECT_LE(fields, 15);
  EXPECT_NEAR(sum / (kDraws - fields), 7.0, 4 * std::sqrt(14.0 / kDraws) + 0.1);
}

TEST(EmCalibration, AFlatFieldIsLeftFlat) {
  std::mt19937 random(3);
  int flat = 0;
  for (int i = 0; i < 100; ++i) {
    EmScene scene;
    scene.pairs = 200;
    if (!HasField(CalibrateEm(DrawEm(scene, random), OptionsOf(scene)))) ++flat;
  }
  EXPECT_GE(flat, 95);
}

TEST(EmCalibration, ABentFieldIsFound) {
  const EmScene scene = Metal();
  std::mt19937 random(4);
  const EmResult result = CalibrateEm(DrawEm(scene, random), OptionsOf(scene));
  ASSERT_EQ(result.status, EmStatus::kOk);
  ASSERT_EQ(result.design.basis.kind, FieldKind::kPolynomial);
  EXPECT_EQ(result.design.basis.order, 2);
  EXPECT_GT(result.rms_before_m, 1.5 * result.rms_after_m);
  EXPECT_NEAR(result.noise_scale, 1.0, 0.05);
  EXPECT_LT(RmsError(result, scene, 5), 1.5e-4);  // noise is 0.45 mm, 900 samples, 27 numbers
}

// The corrected position of a place is as certain as the covariance of everything found says.
TEST(EmCalibration, TheCorrectionsCovarianceIsHonest) {
  EmScene scene = Metal();
  scene.pairs = 300;
  std::mt19937 random(6);
  constexpr int kDraws = 60;
  double sum = 0;
  int counted = 0;
  for (int i = 0; i < kDraws; ++i) {
    const EmResult result = CalibrateEm(DrawEm(scene, random), OptionsOf(scene));
    if (result.design.basis.order != 2 || result.design.free_distance) continue;
    EmScene clean = scene;
    clean.em_noise_m = clean.reference_noise_m = 0;
    clean.pairs = 1;
    const auto place = DrawEm(clean, random);
    const EmRows rows =
        RowsOf({{0, place[0].T_FS, place[0].p_RE, place[0].t_RE, Eigen::Matrix3d::Identity()}},
               result.design, result.solution);
    const Eigen::Matrix3d C = rows.J * result.solution.covariance * rows.J.transpose();
    sum += MahalanobisSquared(rows.r, C);
    ++counted;
  }
  EXPECT_GE(counted, 50);
  EXPECT_NEAR(sum / counted, 3.0, 4 * std::sqrt(6.0 / counted));
}

TEST(EmCalibration, AFieldThatIsNoPolynomialTakesASpline) {
  EmScene scene;
  scene.pairs = 900;
  scene.em_noise_m = scene.reference_noise_m = 1e-4;
  scene.corrected = [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d r = p - Eigen::Vector3d(0.46, 0.06, 0.03);
    return p + 4e-3 * std::exp(-r.squaredNorm() / (2 * 0.04 * 0.04)) * Eigen::Vector3d(0.3, 1, 0.5);
  };
  std::mt19937 random(7);
  const EmResult result = CalibrateEm(DrawEm(scene, random), OptionsOf(scene));
  ASSERT_EQ(result.status, EmStatus::kOk);
  EXPECT_EQ(result.design.basis.kind, FieldKind::kSpline);
  EXPECT_GT(result.rms_before_m, 2 * result.rms_after_m);
  EXPECT_LT(RmsError(result, scene, 8), 0.5 * result.rms_before_m);
}

TEST(EmCalibration, OutliersAreNamedAndNothingElse) {
  for (const bool metal : {false, true}) {
    EmScene scene = metal ? Metal() : EmScene{};
    std::mt19937 random(9);
    auto pairs = DrawEm(scene, random);
    std::vector<bool> bad(pairs.size(), false);
    for (std::size_t i = 10; i < pairs.size(); i += 13) {
      bad[i] = true;
      pairs[i].T_FS.p += Eigen::Vector3d(0.004, -0.02, 0.01);
    }
    const EmResult result = CalibrateEm(pairs, OptionsOf(scene));
    ASSERT_EQ(result.status, EmStatus::kOk);
    EXPECT_EQ(HasField(result), metal);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_EQ(result.residuals[i].used, !bad[i]) << i;
      EXPECT_EQ(result.residuals[i].reason.empty(), !bad[i]) << i;
    }
  }
}

// A path instead of single places; the reference 30 ms behind.
TEST(EmLag, ALateReferenceIsSeen) {
  constexpr double kLate_s = 0.03;
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const auto place = [](double t) -> Eigen::Vector3d {
    return {0.4 + 0.03 * std::sin(2.1 * t), 0.05 * std::sin(1.3 * t), 0.05 * std::cos(1.7 * t)};
  };
  std::vector<EmPair> pairs;
  std::vector<Eigen::Vector3d> errors;
  for (int i = 0; i < 500; ++i) {
    EmPair pair;
    pair.t_ns = i * TimeNs{20'000'000};
    pair.p_RE = place(0.02 * i - kLate_s);
    pairs.push_back(pair);
    errors.emplace_back(place(0.02 * i) - pair.p_RE + 3e-4 * DrawVector<3>(normal, random));
  }
  const EmLag lag = LagOf(pairs, errors, std::vector<bool>(500, true), 0.0);
  EXPECT_LT(lag.sd_s, 3e-4);
  EXPECT_NEAR(lag.late_s, -kLate_s, 4 * lag.sd_s + 0.01 * kLate_s);
}

TEST(EmCalibration, WhatTheMotionDoesNotTellIsRefused) {
  EmScene scene;
  std::mt19937 random(10);
  scene.cone_rad = 0;  // to and fro
  const EmResult line = CalibrateEm(DrawEm(scene, random), OptionsOf(scene));
  EXPECT_EQ(line.status, EmStatus::kUnobservable);
  EXPECT_THAT(line.message, testing::HasSubstr("near a line"));
  EXPECT_EQ(line.unobservable.size(), 3u);

  scene.cone_rad = 0.02;  // hardly another direction: the distance is not told from the place
  const EmResult narrow = CalibrateEm(DrawEm(scene, random), OptionsOf(scene));
  EXPECT_EQ(narrow.status, EmStatus::kOk) << narrow.message;
  EXPECT_FALSE(narrow.design.free_distance);
  ASSERT_FALSE(narrow.unobservable.empty());
  EXPECT_EQ(narrow.unobservable[0].parameter, "em0.distance_from_tip_m");

  scene.cone_rad = 0.35;
  scene.insertion_m = 0;  // on a sphere's cap: near a plane
  scene.cone_rad = 0.15;
  const EmResult plane = CalibrateEm(DrawEm(scene, random), OptionsOf(scene));
  EXPECT_EQ(plane.unobservable.back().parameter, "em0.field");
  EXPECT_THAT(plane.unobservable.back().reason, testing::HasSubstr("plane"));

  scene.pairs = 30;
  EXPECT_EQ(CalibrateEm(DrawEm(scene, random), OptionsOf(scene)).status, EmStatus::kTooFewPairs);
}

}  // namespace
}  // namespace flextip
