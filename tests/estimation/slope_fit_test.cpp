#include "estimation/slope_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/estimation/beam_truth.h"

namespace flextip {
namespace {

BeamFit Fit(const BeamTruth& beam, const SlopeNoise& noise = {}) {
  return FitFromSlopes(beam.p_RW, beam.Tip(), beam.Direction(0), beam.Direction(beam.L), beam.L,
                       noise);
}

TEST(SlopeFit, RecoversTheBeamItWasMadeFrom) {
  for (const double F : {-0.01, -3.0, -40.0}) {
    for (const double fraction : {0.05, 0.3, 0.5, 0.9}) {
      BeamTruth truth;
      truth.F = F;
      truth.a = fraction * truth.L;
      const BeamFit fit = Fit(truth);
      ASSERT_EQ(fit.status, BeamStatus::kOk);
      EXPECT_NEAR(fit.F_p_over_EI, F, 1e-9 * std::abs(F));
      EXPECT_NEAR(fit.a, truth.a, 1e-9);
      EXPECT_LT((fit.R_RM - truth.R_RM).norm(), 1e-9);
      EXPECT_TRUE(fit.covariance.isZero());
    }
  }
}

// The thesis's registration has v_y on the wrist's side (5.7), whichever way the force points.
TEST(SlopeFit, AForceTheOtherWayTurnsTheFrame) {
  BeamTruth truth;
  truth.F = 12.0;
  const BeamFit fit = Fit(truth);
  ASSERT_EQ(fit.status, BeamStatus::kOk);
  EXPECT_NEAR(fit.F_p_over_EI, -12.0, 1e-10);
  EXPECT_LT((fit.R_RM.col(1) + truth.R_RM.col(1)).norm(), 1e-12);
  EXPECT_LT(
      (BeamPort(fit, truth.p_RW) -
       (truth.p_RW + truth.R_RM * Eigen::Vector3d(truth.a, BeamPortHeight(12.0, 0.25, 0.6), 0)))
          .norm(),
      1e-12);
}

TEST(SlopeFit, CovarianceMatchesMonteCarlo) {
  const BeamTruth truth;
  const SlopeNoise noise{.wrist_rad = 0.001, .tip_rad = 0.0015, .chord_rad = 0.0008};
  Noise draw(11);
  std::vector<BeamFit> fits;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p_RE = truth.Tip() + draw.Vector(noise.chord_rad * truth.L);
    fits.push_back(FitFromSlopes(truth.p_RW, p_RE, draw.Turned(truth.Direction(0), noise.wrist_rad),
                                 draw.Turned(truth.Direction(truth.L), noise.tip_rad), truth.L,
                                 noise));
    ASSERT_EQ(fits.back().status, BeamStatus::kOk);
  }
  const Spread spread = SpreadOf(fits);
  const Eigen::Matrix2d predicted = Fit(truth, noise).covariance;
  EXPECT_LT(CovarianceMismatch(spread.covariance, predicted), 0.04);  // 20000 draws scatter by 0.01
  const Eigen::Vector2d sd = predicted.diagonal().cwiseSqrt();
  // F's mean is off by the second order of a's noise, F (1/a^2 + 1/b^2 - 1/(ab)) var(a), here 0.06
  // of its standard deviation: too little to correct for.
  EXPECT_LT(std::abs(spread.mean[0] - truth.F), 0.1 * sd[0]);
  EXPECT_LT(std::abs(spread.mean[1] - truth.a), 0.03 * sd[1]);
}

TEST(SlopeFit, AStraightShaftSaysSo) {
  BeamTruth truth;
  truth.F = 0.0;
  const BeamFit exact = Fit(truth);  // 0/0 in (3.12)
  EXPECT_EQ(exact.status, BeamStatus::kStraight);
  EXPECT_EQ(exact.F_p_over_EI, 0.0);
  EXPECT_LT((exact.R_RM.col(0) - truth.R_RM.col(0)).norm(), 1e-14);
  EXPECT_NEAR((exact.R_RM.transpose() * exact.R_RM - Eigen::Matrix3d::Identity()).norm(), 0, 1e-14);

  const SlopeNoise noise{.wrist_rad = 0.002, .tip_rad = 0.002, .chord_rad = 0.001};
  Noise draw(12);
  int straight = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const BeamFit fit = FitFromSlopes(truth.p_RW, truth.Tip() + draw.Vector(0.001 * truth.L),
                                      draw.Turned(truth.Direction(0), 0.002),
                                      draw.Turned(truth.Direction(truth.L), 0.002), truth.L, noise);
    straight += fit.status == BeamStatus::kStraight;
    ASSERT_TRUE(std::isfinite(fit.F_p_over_EI) && std::isfinite(fit.a) && fit.R_RM.allFinite());
  }
  // exp(-5^2 / 2) of the cases stand out by chance: 0.07 of 20000.
  EXPECT_GE(straight, n - 2);
}

// Whatever the load, a fit that says kOk has a port on the shaft and a covariance to match.
TEST(SlopeFit, WeakBendingNeverGivesAWildPort) {
  const SlopeNoise noise{.wrist_rad = 0.001, .tip_rad = 0.001, .chord_rad = 0.0005};
  Noise draw(13);
  int ok = 0, far_off = 0;
  for (int i = 0; i < 20000; ++i) {
    BeamTruth truth;
    truth.F = -0.5 * (1 + i % 10) / 10.0;  // the ends' directions differ by 2 to 22 mrad
    const BeamFit fit =
        FitFromSlopes(truth.p_RW, truth.Tip() + draw.Vector(noise.chord_rad * truth.L),
                      draw.Turned(truth.Direction(0), noise.wrist_rad),
                      draw.Turned(truth.Direction(truth.L), noise.tip_rad), truth.L, noise);
    ASSERT_TRUE(std::isfinite(fit.F_p_over_EI) && std::isfinite(fit.a));
    if (fit.status != BeamStatus::kOk) continue;
    ++ok;
    EXPECT_GT(fit.a, 0.0);
    EXPECT_LT(fit.a, truth.L);
    far_off += std::abs(fit.a - truth.a) > 4.0 * std::sqrt(fit.covariance(1, 1));
  }
  EXPECT_GT(ok, 5000);
  EXPECT_LT(far_off, ok / 200);
}

TEST(SlopeFit, BendingThatNoPortExplainsIsRefused) {
  const BeamTruth truth;
  const Eigen::Vector3d x = truth.R_RM.col(0), y = truth.R_RM.col(1);
  // Both ends lean the same way: an s-curve, not a beam between two pins.
  const BeamFit s_curve =
      FitFromSlopes(truth.p_RW, truth.Tip(), x + 0.1 * y, x + 0.02 * y, truth.L, {});
  EXPECT_EQ(s_curve.status, BeamStatus::kNoPort);
  // The wrist leans more than twice as much as the tip: the port would be before the wrist.
  EXPECT_EQ(FitFromSlopes(truth.p_RW, truth.Tip(), x + 0.1 * y, x - 0.04 * y, truth.L, {}).status,
            BeamStatus::kNoPort);
  EXPECT_EQ(FitFromSlopes(truth.p_RW, truth.Tip(), -x, x, truth.L, {}).status, BeamStatus::kNoPort);
}

TEST(SlopeFit, BadInputIsRefused) {
  const BeamTruth truth;
  const Eigen::Vector3d x = truth.R_RM.col(0), zero = Eigen::Vector3d::Zero();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto status = [&](const Eigen::Vector3d& tip, const Eigen::Vector3d& t, double L) {
    return FitFromSlopes(truth.p_RW, tip, t, x, L, {}).status;
  };
  EXPECT_EQ(status(truth.p_RW, x, 0.6), BeamStatus::kBadInput);
  EXPECT_EQ(status(truth.Tip(), zero, 0.6), BeamStatus::kBadInput);
  EXPECT_EQ(status(truth.Tip(), {nan, 0, 0}, 0.6), BeamStatus::kBadInput);
  EXPECT_EQ(status(truth.Tip(), x, 0.0), BeamStatus::kBadInput);
  EXPECT_EQ(status(truth.Tip(), x, nan), BeamStatus::kBadInput);
}

// (5.23) for the closed form: the model has both measured slopes, so there is nothing to turn by.
TEST(PrintedGamma, IsZeroForTheClosedForm) {
  const BeamTruth truth;
  Noise draw(14);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d t_wrist = draw.Turned(truth.Direction(0), 0.01);
    const Eigen::Vector3d t_tip = draw.Turned(truth.Direction(truth.L), 0.01);
    const BeamFit fit = FitFromSlopes(truth.p_RW, truth.Tip(), t_wrist, t_tip, truth.L, {});
    ASSERT_EQ(fit.status, BeamStatus::kOk);
    const double measured = fit.R_RM.col(1).dot(t_wrist) / fit.R_RM.col(0).dot(t_wrist);
    const double gamma =
        std::atan(measured) - std::atan(BeamSlope(fit.F_p_over_EI, fit.a, truth.L, 0.0));
    EXPECT_LT(std::abs(gamma), 1e-14);
  }
}

}  // namespace
}  // namespace flextip
