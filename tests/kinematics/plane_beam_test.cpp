#include "kinematics/plane_beam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/derivative_check.h"
#include "core/linear_algebra.h"
#include "tests/kinematics/printed_jacobian.h"

namespace flextip {
namespace {

constexpr BeamLoadLaw kLaws[] = {BeamLoadLaw::kPortForce, BeamLoadLaw::kTipForce};

PlaneBeamProblem Problem(double wrist_to_port, double load, BeamLoadLaw law, double L = 0.355) {
  PlaneBeamProblem problem;
  problem.p_wrist = {-0.11, 0.07};
  problem.p_port = problem.p_wrist + wrist_to_port * Eigen::Vector2d(std::cos(0.6), std::sin(0.6));
  problem.length_m = L;
  problem.law = law;
  problem.load_over_EI = load;
  return problem;
}

// The metric (2.6), ||I - J Jhat^-1||, with unit gain.
double ErrorMetric(const Eigen::Matrix2d& J_true, const Eigen::Matrix2d& J_used) {
  const Eigen::Matrix2d G = Eigen::Matrix2d::Identity() - J_true * J_used.inverse();
  return SingularValues(G)[0];
}

// The bending moment integrated twice from both ends, with no use of (3.1).
TEST(PlaneBeam, ShapeSolvesTheBeamEquation) {
  const double L = 0.5, a = 0.18, F = -7.0, b = L - a;
  const int n = 20000;
  const double h = L / n;
  const auto curvature = [&](double x) { return F * (x <= a ? b / L * x : a / L * (L - x)); };
  double slope = 0.0, y = 0.0;  // with slope 0 at the wrist; the chord is taken off below
  std::vector<double> ys{0.0}, slopes{0.0};
  for (int i = 0; i < n; ++i) {
    const double x = i * h, mid = curvature(x + 0.5 * h);
    y += h * slope + h * h / 6.0 * (curvature(x) + 2.0 * mid);
    slope += h / 6.0 * (curvature(x) + 4.0 * mid + curvature(x + h));
    ys.push_back(y);
    slopes.push_back(slope);
  }
  const double chord = y / L;
  for (int i = 0; i <= n; i += 500) {
    const double x = i * h;
    EXPECT_NEAR(BeamHeight(F, a, L, x), ys[i] - chord * x, 1e-10);
    EXPECT_NEAR(BeamSlope(F, a, L, x), slopes[i] - chord, 1e-9);
  }
  EXPECT_NEAR(BeamPortHeight(F, a, L), BeamHeight(F, a, L, a), 1e-15);
}

TEST(PlaneBeam, SolutionPassesThroughThePortAndCarriesTheLoad) {
  for (const BeamLoadLaw law : kLaws) {
    for (const double load : {-8.0, -1.0, 0.0, 3.0}) {
      for (const double fraction : {0.1, 0.4, 0.7, 0.95}) {
        const PlaneBeamProblem problem = Problem(fraction * 0.355, load, law);
        const PlaneBeam beam = SolvePlaneBeam(problem);
        ASSERT_TRUE(beam.IsUsable());
        const Eigen::Vector2d port_M(beam.a, BeamHeight(beam.F_p_over_EI, beam.a, 0.355, beam.a));
        const Eigen::Vector2d port =
            problem.p_wrist + Eigen::Rotation2Dd(beam.phi).toRotationMatrix() * port_M;  // (3.8)
        EXPECT_LT((port - problem.p_port).norm(), 1e-14);
        EXPECT_NEAR((beam.p_tip - problem.p_wrist).norm(), 0.355, 1e-14);
        const double held =
            law == BeamLoadLaw::kPortForce ? beam.F_p_over_EI : beam.F_p_over_EI * beam.a / 0.355;
        EXPECT_NEAR(held, load, 1e-12);
      }
    }
  }
}

TEST(PlaneBeam, JacobiansMatchCentralDifferences) {
  // Left out: a wrist within 0.05 L of the port or an almost withdrawn tip, where J grows as L / a
  // and the step that differences need is no longer small beside a or b.
  for (const BeamLoadLaw law : kLaws) {
    for (const double load : {-8.0, -3.0, 0.0, 1.0, 8.0}) {
      for (const double fraction : {0.05, 0.1, 0.3, 0.5, 0.8, 0.95}) {
        const PlaneBeamProblem problem = Problem(fraction * 0.355, load, law);
        const PlaneBeam beam = SolvePlaneBeam(problem);
        const auto by_wrist = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
          PlaneBeamProblem moved = problem;
          moved.p_wrist = p;
          return SolvePlaneBeam(moved).p_tip;
        };
        const auto by_port = [&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
          PlaneBeamProblem moved = problem;
          moved.p_port = p;
          return SolvePlaneBeam(moved).p_tip;
        };
        const double step = 2e-3 * fraction * 0.355;
        const Eigen::Matrix2d wrist = NumericJacobian(by_wrist, problem.p_wrist, step);
        const Eigen::Matrix2d port = NumericJacobian(by_port, problem.p_port, step);
        EXPECT_LT((wrist - beam.J_tip_wrist).norm(), 1e-8 * wrist.norm()) << load << fraction;
        EXPECT_LT((port - beam.J_tip_port).norm(), 1e-8 * port.norm()) << load << fraction;
      }
    }
  }
}

TEST(PlaneBeam, PortHeightRateMatchesCentralDifferences) {
  const double L = 0.5, F = -4.0, a0 = 0.13;
  for (const BeamLoadLaw law : kLaws) {
    const auto height = [&](const Eigen::VectorXd& a) -> Eigen::VectorXd {
      const double F_here = law == BeamLoadLaw::kPortForce ? F : F * a0 / a[0];
      return Eigen::VectorXd::Constant(1, BeamPortHeight(F_here, a[0], L));
    };
    const double numeric = NumericJacobian(height, Eigen::VectorXd::Constant(1, a0), 1e-4)(0, 0);
    EXPECT_NEAR(BeamPortHeightRate(F, a0, L, law), numeric, 1e-10);
  }
}

TEST(PlaneBeam, StatusSaysWhyThereIsNoBeam) {
  EXPECT_EQ(SolvePlaneBeam(Problem(0.0, 3, BeamLoadLaw::kTipForce)).status, BeamStatus::kNoPort);
  EXPECT_EQ(SolvePlaneBeam(Problem(0.36, 3, BeamLoadLaw::kTipForce)).status, BeamStatus::kNoPort);
  EXPECT_EQ(SolvePlaneBeam(Problem(0.1, 3, BeamLoadLaw::kTipForce, 0.0)).status,
            BeamStatus::kBadInput);
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(SolvePlaneBeam(Problem(0.1, inf, BeamLoadLaw::kTipForce)).status,
            BeamStatus::kBadInput);
}

TEST(PlaneBeam, HeavyLoadsStillGiveASolutionOnThePort) {
  for (const BeamLoadLaw law : kLaws) {
    for (const double load : {100.0, 1e3, 1e5}) {
      const PlaneBeam beam = SolvePlaneBeam(Problem(0.1, load, law));
      ASSERT_TRUE(beam.IsUsable());
      const double y = BeamPortHeight(beam.F_p_over_EI, beam.a, 0.355);
      EXPECT_NEAR(std::hypot(beam.a, y), 0.1, 1e-12);
    }
  }
}

// --- errata: see docs/errata.md ---

// A beam of the thesis's figures, L = 0.355 m and F_t/EI = 3 1/m^2, with its tip at the insertion
// depth r = |p_t - p_p| of 3.4.
PlaneBeam BeamAtDepth(double depth, PlaneBeamProblem* problem) {
  double low = 1e-3, high = 0.3549;
  PlaneBeam beam;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    *problem = Problem(middle, 3.0, BeamLoadLaw::kTipForce);
    beam = SolvePlaneBeam(*problem);
    ((beam.p_tip - problem->p_port).norm() > depth ? low : high) = middle;
  }
  return beam;
}

struct Metrics {
  double printed, straight;
};
Metrics MetricsAtDepth(double depth) {
  PlaneBeamProblem problem;
  const PlaneBeam beam = BeamAtDepth(depth, &problem);
  const double L = problem.length_m;
  const Eigen::Vector2d d = problem.p_port - problem.p_wrist;
  const Eigen::Matrix2d J_true =
      PlaneBeamJacobian(beam.F_p_over_EI, beam.a, L, beam.phi, BeamLoadLaw::kPortForce);
  const Eigen::Matrix2d printed =
      PrintedJacobian3(BeamPortHeight(beam.F_p_over_EI, beam.a, L), beam.a, L,
                       std::atan2(d.y(), d.x()), d.x(), d.y());
  const Eigen::Vector2d u = d.normalized();
  const Eigen::Matrix2d straight = Eigen::Matrix2d::Identity() -
                                   L / d.norm() * (Eigen::Matrix2d::Identity() - u * u.transpose());
  return {ErrorMetric(J_true, printed), ErrorMetric(J_true, straight)};
}

TEST(PrintedJacobian, IsRightOnlyWithThePortHalfWay) {
  const double L = 0.355, F = -8.0;
  const auto error = [&](double a) {
    const double y = BeamPortHeight(F, a, L);
    const Eigen::Matrix2d J = PlaneBeamJacobian(F, a, L, 0.0, BeamLoadLaw::kPortForce);
    return (PrintedJacobian5(y, a, L, 0.0) - J).norm();
  };
  EXPECT_LT(error(0.5 * L), 1e-14);
  for (const double fraction : {0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9}) {
    EXPECT_GT(error(fraction * L), 1e-3) << fraction;
  }
}

TEST(PrintedJacobian, IsWorseThanTheStraightShaftsOnceTheTipIsDeep) {
  const Metrics at07 = MetricsAtDepth(0.7 * 0.355), at09 = MetricsAtDepth(0.9 * 0.355);
  EXPECT_NEAR(at07.printed, 0.263, 0.001);
  EXPECT_NEAR(at07.straight, 0.088, 0.001);
  EXPECT_NEAR(at09.printed, 2.061, 0.001);
  EXPECT_NEAR(at09.straight, 0.775, 0.001);
}

// The printed (2a - L) stands in for c = 2 (2a - L) / (a (a - L)): for a c where 1 is taken from
// it, for c where it multiplies y^2. With those both printed forms are the true Jacobian.
TEST(PrintedJacobian, HoldsOnceTheMissingFactorsArePutBack) {
  const PlaneBeamProblem problem = Problem(0.12, -5.0, BeamLoadLaw::kPortForce);
  const PlaneBeam beam = SolvePlaneBeam(problem);
  const double a = beam.a, L = problem.length_m, y = BeamPortHeight(beam.F_p_over_EI, a, L);
  const double c = 2.0 * (2.0 * a - L) / (a * (a - L));

  const Eigen::Matrix2d J_M = PlaneBeamJacobian(beam.F_p_over_EI, a, L, 0, BeamLoadLaw::kPortForce);
  const double kappa = (a * c - 1.0) * y / (a + c * y * y);  // (5.34)
  const double k = L / (a * a + y * y);
  EXPECT_NEAR(J_M(1, 0), k * (y + a * kappa), 1e-13);        // (5.32)
  EXPECT_NEAR(J_M(1, 1), 1.0 - k * (a - y * kappa), 1e-13);  // (5.33)

  const Eigen::Vector2d d = problem.p_port - problem.p_wrist;
  const double r2 = d.squaredNorm(), gamma = std::atan(y / a), temp1 = 3.0 * L * y;
  const double ratio = temp1 * (a * c - 1.0) / ((3.0 * L * a + c * temp1 * y) * (a * a + y * y));
  const auto J3 = [&](double phi) {  // (3.16)-(3.19)
    const double sn = std::sin(gamma - phi), cs = std::cos(gamma - phi);
    Eigen::Matrix2d J;
    J << 1 + L * sn * (d.y() / r2 + d.x() * ratio), L * sn * (-d.x() / r2 + d.y() * ratio),
        -L * cs * (-d.y() / r2 - d.x() * ratio), 1 - L * cs * (d.x() / r2 - d.y() * ratio);
    return J;
  };
  // phi must be the angle of the line to the port: (3.7)'s has gamma taken off already.
  EXPECT_LT((J3(std::atan2(d.y(), d.x())) - beam.J_tip_wrist).norm(), 1e-12);
  EXPECT_GT((J3(beam.phi) - beam.J_tip_wrist).norm(), 0.01);
}

// (5.30) and (5.31) carry sin(phi) with the wrong sign. It does no harm: (5.27) makes phi zero.
TEST(PrintedJacobian, FirstRowOfChapter5HasTheWrongSign) {
  const double L = 0.355, a = 0.5 * L, F = -8.0, phi = 0.4;  // half way: the other error vanishes
  const double y = BeamPortHeight(F, a, L);
  // (5.26) of (5.24): dphi stays as it is at (5.27), the tip is moved along (-sin phi, cos phi).
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(phi).toRotationMatrix();
  const Eigen::Matrix2d J_M = PlaneBeamJacobian(F, a, L, 0.0, BeamLoadLaw::kPortForce);
  const Eigen::RowVector2d dphi = J_M.row(1) / L - Eigen::RowVector2d(0, 1.0 / L);
  const Eigen::Matrix2d truth = Eigen::Matrix2d::Identity() + L * R.col(1) * dphi;
  const Eigen::Matrix2d printed = PrintedJacobian5(y, a, L, phi);
  EXPECT_LT((printed.row(1) - truth.row(1)).norm(), 1e-13);
  EXPECT_GT((printed.row(0) - truth.row(0)).norm(), 0.1);
  const Eigen::RowVector2d flipped(2.0 - printed(0, 0), -printed(0, 1));
  EXPECT_LT((flipped - truth.row(0)).norm(), 1e-13);
}

// (3.7)'s arctan of a quotient loses the quadrant once the port is behind the wrist in x.
TEST(PrintedAngle, NeedsTheQuadrant) {
  PlaneBeamProblem problem = Problem(0.15, -3.0, BeamLoadLaw::kTipForce);
  problem.p_port = problem.p_wrist + Eigen::Vector2d(-0.12, 0.09);
  const PlaneBeam beam = SolvePlaneBeam(problem);
  const double y = BeamPortHeight(beam.F_p_over_EI, beam.a, problem.length_m);
  const double printed = std::atan(0.09 / -0.12) - std::atan(y / beam.a);
  EXPECT_NEAR(std::abs(printed - beam.phi), M_PI, 1e-12);
  EXPECT_GT((beam.p_tip - problem.p_port).dot(problem.p_port - problem.p_wrist), 0.0);
}

}  // namespace
}  // namespace flextip
