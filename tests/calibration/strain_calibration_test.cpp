// Gages that are known, on the plant, with noise: found again, and as well as they say.
#include "calibration/shaft/strain_calibration.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "tests/calibration/hung_masses.h"

namespace flextip {
namespace {

using test_support::AllWays;
using test_support::Bench;
using test_support::HungMass;

/// Amplifiers in millivolts, each with its gain and some cross-talk.
Bench GageBench() {
  Bench bench;
  bench.gains << 210, 9, -2, 1,  //
      -7, 190, 0.5, 3,           //
      1, -1, 230, -11,           //
      2, 0.5, 6, 205;
  bench.offset << 12, -30, 4, 55;
  bench.noise.reading = 0.15;
  return bench;
}

/// The squared error of matrix and offset over its covariance: 20 where that is honest.
double Nees(const StrainCalibration& result, const Bench& bench) {
  const Eigen::Matrix4d truth = bench.gains.inverse();
  const auto& numbers = result.found.numbers;
  Eigen::VectorXd error(20);
  error << Eigen::Map<const Eigen::VectorXd>(numbers.at("strain0.gage_matrix").data(), 16) -
               truth.transpose().reshaped(),
      Eigen::Map<const Eigen::VectorXd>(numbers.at("strain0.offset_Nm").data(), 4) - bench.offset;
  const auto& all = result.found.covariance;  // with the noise between the two
  Eigen::MatrixXd C(20, 20);
  C << all.topLeftCorner(16, 16), all.topRightCorner(16, 4), all.bottomLeftCorner(4, 16),
      all.bottomRightCorner(4, 4);
  return MahalanobisSquared(error, C);
}

TEST(StrainCalibration, FindsTheGagesAsWellAsItSays) {
  const Bench bench = GageBench();
  const auto masses = AllWays({-0.08, 0.0, 0.08}, {0.15, 0.3});
  const auto shapes = Hang(bench, masses);
  const double noise = 0.15 * bench.gains.inverse().norm() / 2;
  constexpr int kRuns = 60;
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto result = CalibrateStrain(RecordBench(bench, masses, shapes, 100 + run), "bench");
    ASSERT_TRUE(result.gages_known && result.offset_known);
    nees += Nees(result, bench) / kRuns;
    // One of 75 000 honest holds is left out.
    for (const auto& hold : result.holds) EXPECT_TRUE(hold.used) << hold.reason;
    EXPECT_NEAR(result.moment_noise_Nm, noise, 0.1 * noise);
  }
  EXPECT_NEAR(nees, 20, 3 * std::sqrt(2 * 20.0 / kRuns));
}

TEST(StrainCalibration, NamesTheHoldWithTheWrongMass) {
  const Bench bench = GageBench();
  const auto masses = AllWays({-0.08, 0.0, 0.08}, {0.15, 0.3});
  auto recording = RecordBench(bench, masses, Hang(bench, masses), 7);
  const int wrong = 5, first = wrong * bench.samples;  // half of it was hung
  for (int k = 0; k < bench.samples; ++k) recording.load0->f_tip_N[first + k].value *= 2;
  const auto result = CalibrateStrain(recording, "bench");
  ASSERT_TRUE(result.gages_known);
  for (std::size_t i = 0; i < result.holds.size(); ++i) {
    EXPECT_EQ(result.holds[i].used, i != wrong) << i << ": " << result.holds[i].reason;
  }
  EXPECT_THAT(result.holds[wrong].reason, ::testing::HasSubstr("as if the load were 0.50 times"));
  EXPECT_LT(Nees(result, bench), 45.3);  // one honest result in a thousand exceeds it
}

TEST(StrainCalibration, RefusesColumnsThatNoLoadExcites) {
  const Bench bench = GageBench();
  std::vector<HungMass> masses;
  for (const double x : {-0.08, 0.0, 0.08}) {
    for (const double f : {0.0, 0.15, 0.3, -0.3}) masses.push_back({{x, 0, 0}, {0, 0, f}});
  }
  const auto result = CalibrateStrain(RecordBench(bench, masses, Hang(bench, masses), 3), "bench");
  EXPECT_FALSE(result.gages_known);
  EXPECT_TRUE(result.offset_known);
  ASSERT_EQ(result.found.unobservable.size(), 1);
  EXPECT_EQ(result.found.unobservable[0].parameter, "strain0.gage_matrix");
  EXPECT_THAT(result.found.unobservable[0].reason,
              ::testing::AllOf(::testing::HasSubstr("m1_z, m2_z is not known"),
                               ::testing::HasSubstr("about one axis")));
  EXPECT_FALSE(result.found.numbers.contains("strain0.gage_matrix"));
  EXPECT_TRUE(result.found.numbers.contains("strain0.offset_Nm"));
  EXPECT_THAT(result.advice, ::testing::HasSubstr("y axis"));
}

TEST(StrainCalibration, LoadsOfZeroGiveNoAdviceInNumbersThatAreNone) {
  const Bench bench = GageBench();
  const auto masses = AllWays({-0.08, 0.0, 0.08}, {0.15, 0.3});
  Recording recording = RecordBench(bench, masses, Hang(bench, masses), 3);
  for (auto& sample : recording.load0->f_tip_N) sample.value.setZero();
  const auto result = CalibrateStrain(recording, "bench");
  EXPECT_FALSE(result.gages_known);
  EXPECT_THAT(result.advice, ::testing::Not(::testing::HasSubstr("nan")));
}

TEST(StrainCalibration, OneInsertionDoesForStationsThatAreApart) {
  Bench bench = GageBench();
  bench.gains.topRightCorner<2, 2>().setZero();
  bench.gains.bottomLeftCorner<2, 2>().setZero();
  const auto masses = AllWays({0.0}, {0.15, 0.3});
  const auto recording = RecordBench(bench, masses, Hang(bench, masses), 3);
  const auto together = CalibrateStrain(recording, "bench");
  EXPECT_FALSE(together.gages_known);
  ASSERT_FALSE(together.found.unobservable.empty());
  EXPECT_THAT(together.found.unobservable[0].reason, ::testing::HasSubstr("rise together"));
  const auto apart = CalibrateStrain(recording, "bench", {.fit = {.stations_apart = true}});
  ASSERT_TRUE(apart.gages_known);
  EXPECT_LT((apart.gage_matrix * bench.gains - Eigen::Matrix4d::Identity()).norm(), 0.02);
}

TEST(StrainCalibration, RefusesTheOffsetWithoutAnUnloadedShaft) {
  const Bench bench = GageBench();
  std::vector<HungMass> masses;  // one mass, always the same way across each axis
  for (const double x : {-0.08, 0.0, 0.08}) {
    masses.push_back({{x, 0, 0}, {0, 0, -0.3}});
    masses.push_back({{x, 0, 0}, {0, 0.3, 0}});
  }
  const auto result = CalibrateStrain(RecordBench(bench, masses, Hang(bench, masses), 3), "bench");
  EXPECT_FALSE(result.offset_known);
  EXPECT_THAT(result.found.unobservable.back().reason, ::testing::HasSubstr("unloaded shaft"));
}

TEST(StrainCalibration, SaysWhichStreamIsMissing) {
  const Bench bench = GageBench();
  const auto masses = AllWays({0.0}, {0.3});
  Recording recording = RecordBench(bench, masses, Hang(bench, masses), 3);
  recording.load0.reset();
  try {
    CalibrateStrain(recording, "bench");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("bench: no load0"));
  }
}

}  // namespace
}  // namespace flextip
