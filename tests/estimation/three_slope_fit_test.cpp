#include "estimation/three_slope_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/estimation/beam_truth.h"

namespace flextip {
namespace {

ThreeSlopeFit Fit(const BeamTruth& beam, const SlopeNoise& noise = {}) {
  return FitFromThreeSlopes(beam.p_RW, beam.Tip(), beam.Direction(0), beam.Direction(beam.a),
                            beam.Direction(beam.L), beam.L, noise);
}
constexpr SlopeNoise kNoise{
    .wrist_rad = 0.001, .port_rad = 0.0012, .tip_rad = 0.0015, .chord_rad = 0.0008};

std::vector<BeamFit> Draw(const BeamTruth& truth, bool use_port, unsigned seed, double* mean_chi2) {
  Noise draw(seed);
  std::vector<BeamFit> fits;
  const int n = 20000;
  *mean_chi2 = 0.0;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d p_RE = truth.Tip() + draw.Vector(kNoise.chord_rad * truth.L);
    const Eigen::Vector3d t_wrist = draw.Turned(truth.Direction(0), kNoise.wrist_rad);
    const Eigen::Vector3d t_port = draw.Turned(truth.Direction(truth.a), kNoise.port_rad);
    const Eigen::Vector3d t_tip = draw.Turned(truth.Direction(truth.L), kNoise.tip_rad);
    const ThreeSlopeFit fit =
        FitFromThreeSlopes(truth.p_RW, p_RE, t_wrist, t_port, t_tip, truth.L, kNoise);
    *mean_chi2 += fit.chi2 / n;
    fits.push_back(use_port ? fit.beam
                            : FitFromSlopes(truth.p_RW, p_RE, t_wrist, t_tip, truth.L, kNoise));
    EXPECT_EQ(fits.back().status, BeamStatus::kOk);
  }
  return fits;
}

TEST(ThreeSlopeFit, RecoversTheBeamItWasMadeFrom) {
  for (const double F : {-0.01, -3.0, -40.0}) {
    for (const double fraction : {0.05, 0.3, 0.5, 0.9}) {
      BeamTruth truth;
      truth.F = F;
      truth.a = fraction * truth.L;
      const ThreeSlopeFit fit = Fit(truth);
      ASSERT_EQ(fit.beam.status, BeamStatus::kOk) << F << " " << fraction;
      EXPECT_NEAR(fit.beam.F_p_over_EI, F, 1e-7 * std::abs(F));
      EXPECT_NEAR(fit.beam.a, truth.a, 1e-7);
      EXPECT_LT(std::abs(fit.gamma_rad), 1e-9);
      EXPECT_LT(fit.iterations, 30);
    }
  }
}

TEST(ThreeSlopeFit, CovarianceMatchesMonteCarloAndChi2ItsDegreeOfFreedom) {
  const BeamTruth truth;
  double mean_chi2 = 0.0;
  const Spread spread = SpreadOf(Draw(truth, true, 31, &mean_chi2));
  EXPECT_LT(CovarianceMismatch(spread.covariance, Fit(truth, kNoise).beam.covariance), 0.04);
  EXPECT_NEAR(mean_chi2, 1.0, 0.05);
}

// Why the thesis measures a third direction: the fit is steadier.
TEST(ThreeSlopeFit, IsSteadierThanTwoSlopes) {
  const BeamTruth truth;
  double chi2 = 0.0;
  const Spread two = SpreadOf(Draw(truth, false, 32, &chi2));
  const Spread three = SpreadOf(Draw(truth, true, 32, &chi2));
  EXPECT_LT(three.covariance(1, 1), 0.7 * two.covariance(1, 1));
  EXPECT_LT(three.covariance(0, 0), 1.02 * two.covariance(0, 0));
}

// (5.23) means something here: an over-determined fit leaves an angle.
TEST(PrintedGamma, IsNotZeroForAnOverDeterminedFit) {
  const BeamTruth truth;
  const Eigen::Vector3d t_port = ExpRotation(0.01 * truth.R_RM.col(2)) * truth.Direction(truth.a);
  const ThreeSlopeFit fit = FitFromThreeSlopes(truth.p_RW, truth.Tip(), truth.Direction(0), t_port,
                                               truth.Direction(truth.L), truth.L, kNoise);
  ASSERT_EQ(fit.beam.status, BeamStatus::kOk);
  EXPECT_GT(std::abs(fit.gamma_rad), 1e-4);
  EXPECT_GT(fit.chi2, 1.0);
}

TEST(ThreeSlopeFit, StatusAsForTwoSlopes) {
  BeamTruth truth;
  truth.F = 0.0;
  EXPECT_EQ(Fit(truth, kNoise).beam.status, BeamStatus::kStraight);
  EXPECT_EQ(Fit(truth).beam.status, BeamStatus::kStraight);
  const BeamTruth bent;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto status = [&](const Eigen::Vector3d& t_port) {
    return FitFromThreeSlopes(bent.p_RW, bent.Tip(), bent.Direction(0), t_port,
                              bent.Direction(bent.L), bent.L, kNoise)
        .beam.status;
  };
  EXPECT_EQ(status({nan, 0, 0}), BeamStatus::kBadInput);
  EXPECT_EQ(status(Eigen::Vector3d::Zero()), BeamStatus::kBadInput);
  EXPECT_EQ(status(-bent.R_RM.col(0)), BeamStatus::kNoPort);
}

}  // namespace
}  // namespace flextip
