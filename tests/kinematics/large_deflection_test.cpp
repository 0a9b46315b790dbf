#include "kinematics/large_deflection.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace flextip {
namespace {

// The exact elastica by another road: theta'' = -2 alpha cos(theta) along the unit cantilever,
// theta(0) = 0, theta'(1) = 0, by Runge and Kutta's method and bisection on theta'(0).
struct Elastica {
  double alpha;
  Eigen::Vector4d end;  // theta, theta', x, y

  explicit Elastica(double load) : alpha(load) {
    double low = 0.0, high = 2.0 * alpha;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      end = Shoot(middle);
      (end[1] > 0 ? high : low) = middle;
    }
  }
  Eigen::Vector4d Slope(const Eigen::Vector4d& s) const {
    return {s[1], -2.0 * alpha * std::cos(s[0]), std::cos(s[0]), std::sin(s[0])};
  }
  Eigen::Vector4d Shoot(double root_curvature) const {
    Eigen::Vector4d s(0, root_curvature, 0, 0);
    const int n = 1000;
    const double h = 1.0 / n;
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector4d k1 = Slope(s), k2 = Slope(s + 0.5 * h * k1),
                            k3 = Slope(s + 0.5 * h * k2), k4 = Slope(s + h * k3);
      s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return s;
  }
};

TEST(LargeDeflection, MatchesTheIntegratedElastica) {
  for (const double alpha : {1e-6, 0.01, 0.1, 0.5, 1.0, 2.0, 4.0, kMaxCantileverLoad}) {
    const Cantilever bent = BendCantilever(alpha);
    const Elastica exact(alpha);
    EXPECT_NEAR(bent.phi_end_rad, exact.end[0], 1e-10) << alpha;
    EXPECT_NEAR(bent.reach, exact.end[2], 1e-10) << alpha;
    EXPECT_NEAR(bent.deflection, exact.end[3], 1e-10) << alpha;
  }
}

TEST(LargeDeflection, SmallLoadsGiveTheCantileverBeam) {
  const Cantilever straight = BendCantilever(0.0);
  EXPECT_EQ(straight.phi_end_rad, 0.0);
  EXPECT_NEAR(straight.reach, 1.0, 1e-15);
  const double alpha = 1e-5;  // F l^2 / (2 EI) is the slope, 2/3 of it the deflection
  EXPECT_NEAR(BendCantilever(alpha).phi_end_rad, alpha, 1e-9 * alpha);
  EXPECT_NEAR(BendCantilever(alpha).deflection, 2.0 / 3.0 * alpha, 1e-9 * alpha);
}

TEST(LargeDeflection, LoadsBeyondTheBoundGiveTheBoundsShape) {
  EXPECT_EQ(BendCantilever(1e9).reach, BendCantilever(kMaxCantileverLoad).reach);
}

TEST(LargeDeflection, ChordOfAStraightShaftIsItsLength) {
  EXPECT_NEAR(BentChord(0.0, 0.1, 0.4), 0.4, 1e-15);
}

TEST(LargeDeflection, ChordDoesNotCareForTheLoadsSign) {
  EXPECT_EQ(BentChord(9.0, 0.1, 0.4), BentChord(-9.0, 0.1, 0.4));
}

// (5.18) as printed, cut off at sin(phi) = (1 - cut) sin(phi_end): it grows without bound as the
// cut shrinks, so it defines no load.
TEST(PrintedLoadIntegral, Diverges) {
  const double end = 0.3;
  const auto printed = [&](double cut) {
    // phi = end - exp(t): equal steps in the logarithm of the distance to the end.
    const double from = std::log(cut), to = std::log(end);
    const int n = 20000;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
      const double gap = std::exp(from + (i + 0.5) * (to - from) / n);
      sum += gap / (4.0 * (std::sin(end) - std::sin(end - gap)));
    }
    return sum * (to - from) / n;
  };
  // Each further factor 1e-3 of the cut adds ln(1000) / (4 cos(end)).
  const double growth = std::log(1e3) / (4.0 * std::cos(end));
  EXPECT_NEAR(printed(1e-6) - printed(1e-3), growth, 1e-3 * growth);
  EXPECT_NEAR(printed(1e-9) - printed(1e-6), growth, 1e-3 * growth);
}

}  // namespace
}  // namespace flextip
