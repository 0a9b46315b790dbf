#include "estimation/moment_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/estimation/beam_truth.h"

namespace flextip {
namespace {

// The gauges of chapter 4: 150 mm from the wrist, 100 mm from the tip.
MomentPair Measure(const BeamTruth& beam, double noise = 0.0) {
  return {beam.Moment(0.15), beam.Moment(0.5), 0.15, 0.5, noise};
}

TEST(MomentFit, RecoversTheBeamItWasMadeFrom) {
  for (const double F : {-0.01, -3.0, -40.0}) {
    for (const double a : {0.16, 0.3, 0.49}) {
      BeamTruth truth;
      truth.F = F;
      truth.a = a;
      const BeamFit fit =
          FitFromMoments(truth.p_RW, truth.Tip(), Measure(truth), truth.EI, truth.L);
      ASSERT_EQ(fit.status, BeamStatus::kOk);
      EXPECT_NEAR(fit.F_p_over_EI, F, 1e-12 * std::abs(F));
      EXPECT_NEAR(fit.a, a, 1e-12);
      EXPECT_LT((fit.R_RM - truth.R_RM).norm(), 1e-12);
    }
  }
}

TEST(MomentFit, AgreesWithTheSlopes) {
  const BeamTruth truth;
  const BeamFit moments =
      FitFromMoments(truth.p_RW, truth.Tip(), Measure(truth), truth.EI, truth.L);
  const BeamFit slopes = FitFromSlopes(truth.p_RW, truth.Tip(), truth.Direction(0),
                                       truth.Direction(truth.L), truth.L, {});
  EXPECT_NEAR(moments.F_p_over_EI, slopes.F_p_over_EI, 1e-10);
  EXPECT_NEAR(moments.a, slopes.a, 1e-10);
  EXPECT_LT((moments.R_RM - slopes.R_RM).norm(), 1e-10);
}

// The closed form against (5) and (6) as they stand.
TEST(MomentFit, IsTheThesisFormula) {
  const BeamTruth truth;
  const MomentPair m = Measure(truth);
  const double M_w = m.m1_Nm.dot(truth.R_RM.col(2)), M_t = m.m2_Nm.dot(truth.R_RM.col(2));
  const double a = M_t * 0.15 * truth.L / (M_t * 0.15 + M_w * (truth.L - 0.5));
  const double F_p = M_w * truth.L / (0.15 * (truth.L - a));
  const BeamFit fit = FitFromMoments(truth.p_RW, truth.Tip(), m, truth.EI, truth.L);
  EXPECT_NEAR(fit.a, a, 1e-13);
  EXPECT_NEAR(fit.F_p_over_EI * truth.EI, F_p, 1e-12);
}

TEST(MomentFit, CovarianceMatchesMonteCarlo) {
  const BeamTruth truth;
  const double noise = 0.003;
  Noise draw(21);
  std::vector<BeamFit> fits;
  for (int i = 0; i < 20000; ++i) {
    MomentPair m = Measure(truth, noise);
    m.m1_Nm += draw.Vector(noise);
    m.m2_Nm += draw.Vector(noise);
    fits.push_back(FitFromMoments(truth.p_RW, truth.Tip(), m, truth.EI, truth.L));
    ASSERT_EQ(fits.back().status, BeamStatus::kOk);
  }
  const Spread spread = SpreadOf(fits);
  const Eigen::Matrix2d predicted =
      FitFromMoments(truth.p_RW, truth.Tip(), Measure(truth, noise), truth.EI, truth.L).covariance;
  EXPECT_LT(CovarianceMismatch(spread.covariance, predicted), 0.04);
  const Eigen::Vector2d sd = predicted.diagonal().cwiseSqrt();
  EXPECT_LT(std::abs(spread.mean[0] - truth.F), 0.03 * sd[0]);
  EXPECT_LT(std::abs(spread.mean[1] - truth.a), 0.03 * sd[1]);
}

TEST(MomentFit, NoiseAloneIsAStraightShaft) {
  BeamTruth truth;
  truth.F = 0.0;
  EXPECT_EQ(FitFromMoments(truth.p_RW, truth.Tip(), Measure(truth), truth.EI, truth.L).status,
            BeamStatus::kStraight);
  Noise draw(22);
  int straight = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    MomentPair m = Measure(truth, 0.003);
    m.m1_Nm += draw.Vector(0.003);
    m.m2_Nm += draw.Vector(0.003);
    const BeamFit fit = FitFromMoments(truth.p_RW, truth.Tip(), m, truth.EI, truth.L);
    straight += fit.status == BeamStatus::kStraight;
    ASSERT_TRUE(std::isfinite(fit.F_p_over_EI) && std::isfinite(fit.a) && fit.R_RM.allFinite());
  }
  EXPECT_GE(straight, n - 2);
}

TEST(MomentFit, RefusesWhatNoPortBetweenTheStationsExplains) {
  const BeamTruth truth;
  const auto status = [&](const MomentPair& m) {
    return FitFromMoments(truth.p_RW, truth.Tip(), m, truth.EI, truth.L).status;
  };
  MomentPair m = Measure(truth);
  m.m2_Nm *= -1.0;
  EXPECT_EQ(status(m), BeamStatus::kNoPort);
  m = Measure(truth);
  m.m2_Nm *= 0.01;
  EXPECT_EQ(status(m), BeamStatus::kNoPort);  // before the first station
  m = Measure(truth);
  m.station1_m = 0.55;
  EXPECT_EQ(status(m), BeamStatus::kBadInput);
  m = Measure(truth);
  m.m1_Nm[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status(m), BeamStatus::kBadInput);
  EXPECT_EQ(FitFromMoments(truth.p_RW, truth.Tip(), Measure(truth), 0.0, truth.L).status,
            BeamStatus::kBadInput);
}

}  // namespace
}  // namespace flextip
