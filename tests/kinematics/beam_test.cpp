#include "kinematics/beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/derivative_check.h"
#include "kinematics/large_deflection.h"
#include "kinematics/plane_beam.h"
#include "kinematics/straight.h"
#include "tests/kinematics/rod_reference.h"

namespace flextip {
namespace {

constexpr BeamLoadLaw kLaws[] = {BeamLoadLaw::kPortForce, BeamLoadLaw::kTipForce};

Eigen::Vector3d Random(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return {uniform(rng), uniform(rng), uniform(rng)};
}

TEST(Beam, PassesThroughThePortUnderTheForce) {
  std::mt19937 rng(3);
  const double L = 0.5, EI = 0.4;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p_RW = Random(rng);
    const Eigen::Vector3d p_RP = p_RW + 0.25 * Random(rng).normalized();
    const Eigen::Vector3d f = 2.0 * Random(rng);
    const BeamFit fit = SolveBeam(p_RW, p_RP, f, EI, L);
    ASSERT_TRUE(fit.IsUsable());
    EXPECT_LT((BeamPort(fit, p_RW) - p_RP).norm(), 1e-13);
    EXPECT_LE(fit.F_p_over_EI, 0.0);
    EXPECT_NEAR(fit.R_RM.determinant(), 1.0, 1e-13);
    // The load the beam carries is the force without its part along the chord.
    const Eigen::Vector3d v_x = fit.R_RM.col(0);
    EXPECT_LT((EI * BeamTipLoad(fit) - (f - f.dot(v_x) * v_x)).norm(), 1e-11);
  }
}

// The true derivative of the 3-D construction: wrist moved, port fixed, the plane spanned by the
// line to the port and the direction of the load, whose size the law holds constant.
TEST(Beam, JacobianMatchesCentralDifferencesIn3D) {
  std::mt19937 rng(4);
  const double L = 0.5;
  for (const BeamLoadLaw law : kLaws) {
    for (const double distance : {0.06, 0.2, 0.35, 0.45}) {
      const Eigen::Vector3d p_RW = Random(rng), u = Random(rng).normalized();
      const Eigen::Vector3d p_RP = p_RW + distance * u;
      // A force square to the chord: the beam's own assumption, under which (5.28)'s axis holds.
      BeamFit fit = SolveBeam(p_RW, p_RP, 1.5 * Random(rng), 0.4, L);
      const Eigen::Vector3d side = fit.R_RM.col(1);
      const double F_t = fit.F_p_over_EI * fit.a / L;
      const double load = law == BeamLoadLaw::kPortForce ? fit.F_p_over_EI : F_t;
      const auto tip = [&](const Eigen::VectorXd& wrist) -> Eigen::VectorXd {
        const Eigen::Vector3d to_port = p_RP - wrist, normal = to_port.cross(side).normalized();
        const Eigen::Vector3d e1 = to_port.normalized(), e2 = normal.cross(e1);
        PlaneBeamProblem problem;
        problem.p_port = {to_port.norm(), 0.0};
        problem.length_m = L;
        problem.law = law;
        problem.load_over_EI = load;
        const PlaneBeam beam = SolvePlaneBeam(problem);
        return wrist + beam.p_tip.x() * e1 + beam.p_tip.y() * e2;
      };
      const Eigen::Matrix3d numeric = NumericJacobian(tip, p_RW, 1e-3 * distance);
      EXPECT_LT((numeric - BeamJacobian(fit, law)).norm(), 1e-8 * numeric.norm()) << distance;
    }
  }
}

TEST(Beam, UnloadedJacobianIsTheLevers) {
  const Eigen::Vector3d p_RW(0.1, 0.2, 0.3), p_RP(0.2, 0.1, 0.25);
  const BeamFit fit = SolveBeam(p_RW, p_RP, Eigen::Vector3d::Zero(), 0.3, 0.4);
  EXPECT_EQ(fit.status, BeamStatus::kStraight);
  const StraightShaft shaft = SolveStraight(p_RW, p_RP, 0.4);
  for (const BeamLoadLaw law : kLaws) {
    EXPECT_LT((BeamJacobian(fit, law) - shaft.J_tip_wrist).norm(), 1e-13);
  }
  EXPECT_LT((BeamTip(fit, p_RW) - shaft.p_tip).norm(), 1e-14);
  EXPECT_TRUE(BeamTipLoad(fit).isZero());
}

TEST(Beam, StatusSaysWhyThereIsNoBeam) {
  const Eigen::Vector3d wrist(0, 0, 0), port(0.2, 0, 0), f(0, 0, -1);
  EXPECT_EQ(SolveBeam(wrist, wrist, f, 0.3, 0.4).status, BeamStatus::kNoPort);
  EXPECT_EQ(SolveBeam(wrist, port, f, 0.3, 0.19).status, BeamStatus::kNoPort);
  EXPECT_EQ(SolveBeam(wrist, port, f, 0.0, 0.4).status, BeamStatus::kBadInput);
  EXPECT_EQ(SolveBeam(wrist, port, f, 0.3, -0.4).status, BeamStatus::kBadInput);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SolveBeam(wrist, port, {0, nan, 0}, 0.3, 0.4).status, BeamStatus::kBadInput);
  EXPECT_EQ(SolveBeam({nan, 0, 0}, port, f, 0.3, 0.4).status, BeamStatus::kBadInput);
}

// --- against the exact rod ---

bool IsWeightless(const ReferenceRow& row) { return Vector(row, "q_weight_N_per_m").isZero(); }

TEST(Beam, LightlyLoadedRodsAreBeams) {
  const auto rows = ReadRodReference();
  ASSERT_FALSE(rows.empty());
  int checked = 0;
  for (const ReferenceRow& row : rows) {
    const RodProblem rod = Problem(row);
    const double L = rod.length_m;
    const double load = rod.f_tip.norm() * L * L / rod.bending_stiffness_Nm2;
    if (!IsWeightless(row) || load > 0.1) continue;
    const BeamFit fit = SolveBeam(rod.p_wrist, rod.p_port, rod.f_tip, rod.bending_stiffness_Nm2, L);
    ASSERT_TRUE(fit.IsUsable());
    const double straight =
        (SolveStraight(rod.p_wrist, rod.p_port, L).p_tip - Vector(row, "p_tip_m")).norm();
    const double beam = (rod.p_wrist + L * fit.R_RM.col(0) - Vector(row, "p_tip_m")).norm();
    // The beam leaves the axial force out, which matters as its share of the load at which the
    // shaft would buckle between pins, pi^2 EI / L^2. The worst of these rows reaches 0.9 of it.
    EXPECT_LT(beam, load / (M_PI * M_PI) * straight + 1e-9);
    ++checked;
  }
  EXPECT_GT(checked, 30);
}

// The chord from wrist to tip: the shaft's length, the thesis's sum of two reaches (5.19), and the
// sum with the two sides' unequal deflections. Relative to L, over loads up to F_t L^2/EI = 2.5:
// rms 3.6e-3, 1.2e-3, 3.4e-4.
TEST(Beam, BentChordIsNearerTheRodsThanTheStraightLength) {
  const auto rows = ReadRodReference();
  ASSERT_FALSE(rows.empty());
  double sum_straight = 0, sum_thesis = 0, sum_ours = 0, worst = 0;
  int n = 0;
  for (const ReferenceRow& row : rows) {
    if (!IsWeightless(row)) continue;
    const RodProblem rod = Problem(row);
    const double L = rod.length_m, chord = (Vector(row, "p_tip_m") - rod.p_wrist).norm();
    const BeamFit fit = SolveBeam(rod.p_wrist, rod.p_port, rod.f_tip, rod.bending_stiffness_Nm2, L);
    ASSERT_TRUE(fit.IsUsable());
    const double a = fit.a, b = L - a, F = std::abs(fit.F_p_over_EI);
    const double thesis = a * BendCantilever(0.5 * F * b / L * a * a).reach +
                          b * BendCantilever(0.5 * F * a / L * b * b).reach;
    sum_straight += std::pow((L - chord) / L, 2);
    sum_thesis += std::pow((thesis - chord) / L, 2);
    sum_ours += std::pow((BentChord(F, a, L) - chord) / L, 2);
    worst = std::max(worst, std::abs(BentChord(F, a, L) - chord) / L);
    ++n;
  }
  const double straight = std::sqrt(sum_straight / n), thesis = std::sqrt(sum_thesis / n),
               ours = std::sqrt(sum_ours / n);
  RecordProperty("rms_straight", std::to_string(straight));
  RecordProperty("rms_thesis", std::to_string(thesis));
  RecordProperty("rms_ours", std::to_string(ours));
  RecordProperty("worst_ours", std::to_string(worst));
  EXPECT_LT(thesis, straight);
  EXPECT_LT(ours, thesis);
}

}  // namespace
}  // namespace flextip
