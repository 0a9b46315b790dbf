// Normal vectors that cannot be negative, against sampling and long double arithmetic.
#include "diagnosis/evidence/half_normal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

TEST(HalfNormal, LogPhiIsRightFarOut) {
  for (double x = -30.0; x < 8.0; x += 0.173) {
    const long double exact = std::log(0.5L * erfcl(-static_cast<long double>(x) / sqrtl(2.0L)));
    EXPECT_NEAR(LogPhi(x), double(exact), 1e-9 * std::abs(double(exact)) + 1e-15) << x;
  }
  EXPECT_NEAR(LogPhi(-1e4), -5e7 - std::log(1e4) - 0.918938533, 1e-6);
}

Eigen::Matrix2d Correlated(double rho) {
  Eigen::Matrix2d C;
  C << 1.0, 2.0 * rho, 2.0 * rho, 4.0;
  return C;
}

/// Both halves at once: the quadrant's probability about zero is known in closed form, elsewhere it
/// is counted.
TEST(HalfNormal, ProbabilityOfAQuadrant) {
  for (const double rho : {-0.6, -0.2, 0.0, 0.5, 0.8}) {
    const double exact = 0.25 + std::asin(rho) / (2.0 * std::acos(-1.0));
    EXPECT_NEAR(std::exp(LogPositive(Eigen::Vector2d::Zero(), Correlated(rho), {0, 1})), exact,
                0.02)
        << rho;
    std::mt19937_64 rng(3);
    std::normal_distribution<double> normal;
    const Eigen::Matrix2d L = Llt(Correlated(rho)).L();
    const Eigen::Vector2d mean(-1.2, 0.7);
    int inside = 0;
    constexpr int kDraws = 400000;
    for (int i = 0; i < kDraws; ++i) {
      const Eigen::Vector2d unit = DrawVector<2>(normal, rng);
      inside += ((mean + L * unit).array() > 0.0).all() ? 1 : 0;
    }
    EXPECT_NEAR(LogPositive(mean, Correlated(rho), {0, 1}), std::log(double(inside) / kDraws), 0.1)
        << rho;
  }
}

/// A strongly negative slope on two of them: no promise is left, whatever the correlation.
TEST(HalfNormal, FarOutNothingIsLeftToGain) {
  const Eigen::Matrix2d C = Correlated(-0.95);
  const Eigen::Vector2d slope(-50.0, -30.0), mean = C * slope;
  // 4 * integral over the quadrant of N(x; 0, C) exp(slope . x): at most 1.
  const double log = 0.5 * slope.dot(C * slope) + LogPositive(mean, C, {0, 1}) + std::log(4.0);
  EXPECT_LT(log, 0.0);
  EXPECT_GT(log, -20.0);
}

TEST(HalfNormal, ModeIsTheBestPointOfTheQuadrant) {
  const Eigen::Matrix2d C = Correlated(0.7), H = C.inverse();
  for (const Eigen::Vector2d& mean : {Eigen::Vector2d(1, 2), Eigen::Vector2d(-1, 2),
                                      Eigen::Vector2d(0.3, -3), Eigen::Vector2d(-2, -2)}) {
    const Eigen::VectorXd mode = PositiveMode(mean, C, {0, 1});
    const auto cost = [&](const Eigen::Vector2d& x) { return (x - mean).dot(H * (x - mean)); };
    double best = 1e300;
    for (double x = 0.0; x < 4.0; x += 0.01)
      for (double y = 0.0; y < 4.0; y += 0.01) best = std::min(best, cost({x, y}));
    EXPECT_GE(mode.minCoeff(), 0.0);
    EXPECT_LE(cost(mode), best + 1e-6) << mean.transpose();
  }
}

/// Twelve of them: no better point by any small allowed step.
TEST(HalfNormal, ModeOfManyIsTheBestPoint) {
  constexpr int n = 12;
  Eigen::MatrixXd A(n, n);
  Eigen::VectorXd mean(n);
  for (int i = 0; i < n; ++i) {
    mean[i] = std::sin(3.0 * i + 1.0);
    for (int j = 0; j < n; ++j) A(i, j) = std::cos(1.7 * i * j + 0.3 * j) + (i == j ? 2.0 : 0.0);
  }
  const Eigen::MatrixXd C = A * A.transpose(), H = C.inverse();
  std::vector<int> positive;
  for (int i = 0; i < n; ++i) positive.push_back(i);
  const Eigen::VectorXd mode = PositiveMode(mean, C, positive);
  EXPECT_GE(mode.minCoeff(), 0.0);
  const Eigen::VectorXd slope = H * (mode - mean);
  for (int i = 0; i < n; ++i) {
    if (mode[i] > 1e-9) EXPECT_NEAR(slope[i], 0.0, 1e-8);
    EXPECT_GE(slope[i], -1e-8);
  }
}

}  // namespace
}  // namespace flextip::diagnosis
