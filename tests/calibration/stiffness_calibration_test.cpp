// A stiffness that is known, on the plant, with noise: found again, and as well as it says.
#include "calibration/shaft/stiffness_calibration.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "tests/calibration/hung_masses.h"

namespace flextip {
namespace {

using test_support::AllWays;
using test_support::Bench;
using ::testing::HasSubstr;

/// The recording says 0.304; the shaft is something else.
Bench SoftBench(double scale, double taper) {
  Bench bench;
  bench.effects.stiffness_scale = scale;
  bench.effects.taper = -taper / 2;  // the plant's is 1 + taper (1 - 2 s / L)
  bench.samples = 5;
  bench.noise.reading = 1e-3;
  return bench;
}

TEST(StiffnessCalibration, FindsAConstantStiffnessAsWellAsItSays) {
  const Bench bench = SoftBench(0.85, 0.0);
  const auto masses = AllWays({-0.08, 0.08}, {0.3});
  const auto shapes = Hang(bench, masses);
  constexpr int kRuns = 40;
  double nees = 0, chi2 = 0;
  for (int run = 0; run < kRuns; ++run) {
    Recording recording = RecordBench(bench, masses, shapes, 500 + run);
    if (run % 3 == 0) recording.em0.reset();
    if (run % 3 == 1) recording.vision0.reset();
    if (run % 5 == 0) recording.strain0.reset();
    const auto result =
        CalibrateStiffness(recording, "bench", {.choice = StiffnessChoice::kConstant});
    ASSERT_EQ(result.status, StiffnessStatus::kOk) << run << " " << result.chosen().chi2_per_dof;
    const double error = result.chosen().stiffness_Nm2 - 0.85 * 0.304;
    nees += std::pow(error / result.chosen().stiffness_sd_Nm2, 2) / kRuns;
    chi2 += result.chosen().chi2_per_dof / kRuns;
    EXPECT_LT(result.chosen().stiffness_sd_Nm2, 0.02 * 0.304);
  }
  EXPECT_NEAR(nees, 1, 3 * std::sqrt(2.0 / kRuns));
  EXPECT_NEAR(chi2, 1, 0.1);  // of some 90 measurements each
}

TEST(StiffnessCalibration, FindsATaperAsWellAsItSays) {
  const Bench bench = SoftBench(1.1, -0.5);
  const auto masses = AllWays({-0.12, 0.0, 0.12}, {0.4});
  const auto shapes = Hang(bench, masses);
  constexpr int kRuns = 20;
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    Recording recording = RecordBench(bench, masses, shapes, 900 + run);
    if (run % 2 == 0) recording.em0.reset();
    const auto result = CalibrateStiffness(recording, "bench", {.choice = StiffnessChoice::kTaper});
    ASSERT_EQ(result.status, StiffnessStatus::kOk) << result.chosen().chi2_per_dof;
    const Eigen::Vector2d error(
        result.found.numbers.at("instrument.bending_stiffness_Nm2")[0] - 1.1 * 0.304,
        result.found.numbers.at("instrument.stiffness_taper")[0] + 0.5);
    nees += MahalanobisSquared(error, result.found.covariance) / kRuns;
    EXPECT_LT(result.chosen().taper_sd, 0.1);
  }
  EXPECT_NEAR(nees, 2, 3 * std::sqrt(4.0 / kRuns));
}

TEST(StiffnessCalibration, TakesATaperWhereItPredictsBetter) {
  for (const double taper : {-0.5, 0.0, 0.5}) {
    const Bench bench = SoftBench(1.0, taper);
    const auto masses = AllWays({-0.12, 0.0, 0.12}, {0.4});
    const auto result =
        CalibrateStiffness(RecordBench(bench, masses, Hang(bench, masses), 31), "bench");
    EXPECT_EQ(result.taper_chosen, taper != 0.0) << taper;
    EXPECT_EQ(result.tapered->heldout_tip_rms_m < 0.9 * result.constant->heldout_tip_rms_m,
              taper != 0.0);
  }
}

TEST(StiffnessCalibration, NamesTheHoldWithTheWrongMass) {
  const Bench bench = SoftBench(0.85, 0.0);
  const auto masses = AllWays({-0.08, 0.0, 0.08}, {0.15, 0.3});
  Recording recording = RecordBench(bench, masses, Hang(bench, masses), 5);
  const int wrong = 7, first = wrong * bench.samples;
  for (int k = 0; k < bench.samples; ++k) recording.load0->f_tip_N[first + k].value *= 0.5;
  const auto result = CalibrateStiffness(recording, "bench");
  for (std::size_t i = 0; i < result.holds.size(); ++i) {
    EXPECT_EQ(result.holds[i].used, i != wrong) << i << ": " << result.holds[i].reason;
  }
  EXPECT_THAT(result.holds[wrong].reason, HasSubstr("mm from where the load should bend it"));
  EXPECT_NEAR(result.chosen().stiffness_Nm2, 0.85 * 0.304, 4 * result.chosen().stiffness_sd_Nm2);
}

TEST(StiffnessCalibration, RefusesLoadsThatAreTooSmall) {
  const Bench bench = SoftBench(0.85, 0.0);
  const auto masses = AllWays({-0.08, 0.0, 0.08}, {0.001});
  const auto result =
      CalibrateStiffness(RecordBench(bench, masses, Hang(bench, masses), 5), "bench");
  EXPECT_EQ(result.status, StiffnessStatus::kUnobservable);
  EXPECT_TRUE(result.found.numbers.empty());
  ASSERT_EQ(result.found.unobservable.size(), 2);
  EXPECT_EQ(result.found.unobservable[0].parameter, "instrument.bending_stiffness_Nm2");
  EXPECT_THAT(result.found.unobservable[0].reason, HasSubstr("hang more"));
  EXPECT_EQ(result.found.unobservable[1].parameter, "instrument.stiffness_taper");
}

TEST(StiffnessCalibration, SaysWhenTheModelIsIncomplete) {
  Bench bench = SoftBench(1.0, 0.0);
  bench.effects.port_compliance_m_N = 2e-3;  // the body wall gives way
  const auto masses = AllWays({-0.08, 0.0, 0.08}, {0.15, 0.3});
  const auto result =
      CalibrateStiffness(RecordBench(bench, masses, Hang(bench, masses), 5), "bench");
  EXPECT_EQ(result.status, StiffnessStatus::kModelIncomplete);
  EXPECT_GT(result.chosen().chi2_per_dof, 3);
}

TEST(StiffnessCalibration, SaysWhichStreamIsMissing) {
  const Bench bench = SoftBench(1.0, 0.0);
  const auto masses = AllWays({0.0}, {0.3});
  Recording recording = RecordBench(bench, masses, Hang(bench, masses), 5);
  recording.vision0.reset();
  recording.em0.reset();
  try {
    CalibrateStiffness(recording, "bench");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("bench: no vision0 and no em0"));
  }
}

}  // namespace
}  // namespace flextip
