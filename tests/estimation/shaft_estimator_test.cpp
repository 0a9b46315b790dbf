#include "estimation/shaft_estimator.h"

#include <gtest/gtest.h>

#include <random>

#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "estimation/rod_fit.h"
#include "sensor_bench.h"

namespace flextip {
namespace {

TEST(ShaftEstimator, RecoversTheLoadFromEverySetOfSensorsWithoutNoise) {
  for (const SensorSet& set : kSets) {
    SensorBench bench;
    ShaftEstimator estimator(BenchOptions(set.use_positions));
    const RodState truth = RodSolver().Solve(BenchShaft());
    const ShaftEstimate e = estimator.Update(bench.Measure(BenchShaft(), set.sensors, 0.0));
    ASSERT_EQ(e.status, EstimateStatus::kOk) << set.name;
    // Without noise only the priors pull: the force along the shaft, which hardly bends it,
    // towards nothing. The error must be within what the covariance says of that.
    const Eigen::Vector3d miss = e.model.f_tip_N - kBenchForce;
    const Eigen::Matrix3d covariance = e.covariance.bottomRightCorner<3, 3>();
    EXPECT_LT(MahalanobisSquared(miss, covariance), 1.0) << set.name;
    EXPECT_LT((e.p_RE - truth.tip.p).norm(), 2e-4) << set.name;
    EXPECT_TRUE(e.model.beam.IsUsable()) << set.name;
  }
}

TEST(ShaftEstimator, CovarianceMatchesMonteCarlo) {
  for (const SensorSet& set : kSets) {
    SensorBench bench;
    std::mt19937_64 rng(5);
    std::normal_distribution<double> normal;
    const EstimatorOptions options = BenchOptions(set.use_positions);
    const double unit = kBenchStiffness / (kBenchLength * kBenchLength);
    double nees = 0.0;
    const int runs = 300;
    int used = 0;
    for (int i = 0; i < runs; ++i) {
      // Truth drawn from the priors as well: only then is the covariance the error's.
      RodProblem problem = BenchShaft();
      const auto draw = [&] { return DrawVector<3>(normal, rng); };
      problem.p_port += options.port_prior_m * draw();
      problem.f_tip = 0.25 * options.force_prior_units * unit * draw();
      const RodState truth = RodSolver().Solve(problem);
      if (!truth.IsUsable()) continue;
      ShaftEstimator estimator(options);
      const ShaftEstimate e = estimator.Update(bench.Measure(problem, set.sensors, 1.0));
      ASSERT_EQ(e.status, EstimateStatus::kOk) << set.name;
      const Eigen::Vector3d miss = e.p_RE - truth.tip.p;
      nees += MahalanobisSquared(miss, e.p_RE_covariance_m2);
      ++used;
    }
    ASSERT_GT(used, runs * 9 / 10);
    // The mean of chi2 with 3 degrees of freedom over 300 runs: 3 +- 0.14.
    EXPECT_GT(nees / used, 2.4) << set.name;
    EXPECT_LT(nees / used, 3.6) << set.name;
  }
}

TEST(ShaftEstimator, SaysWhenTheLoadCannotBeSeen) {
  SensorBench bench;
  ShaftEstimator estimator(BenchOptions(false));
  // The tip's position may not be used, and nothing else is there.
  const ShaftEstimate e = estimator.Update(bench.Measure(BenchShaft(), kTip, 0.0));
  EXPECT_EQ(e.status, EstimateStatus::kUnobservable);
  EXPECT_FALSE(e.model.force_known);
  EXPECT_EQ(e.model.f_tip_N, Eigen::Vector3d::Zero());
  EXPECT_FALSE(e.model.beam.IsUsable());
  EXPECT_TRUE(e.p_RE.allFinite());
}

TEST(ShaftEstimator, UnloadedShaftGivesNoWildPort) {
  SensorBench bench;
  RodProblem problem = BenchShaft();
  problem.f_tip.setZero();
  for (int i = 0; i < 50; ++i) {
    ShaftEstimator estimator(BenchOptions());
    const ShaftEstimate e = estimator.Update(bench.Measure(problem, kWristDirection | kEm, 1.0));
    ASSERT_EQ(e.status, EstimateStatus::kOk);
    EXPECT_LT((e.model.p_RP - kBenchPort).norm(), 0.002);
    EXPECT_LT(e.model.f_tip_N.norm(), 2.5);
  }
}

TEST(ShaftEstimator, BadInputAndUnreachablePortAreStatuses) {
  SensorBench bench;
  Measurements z = bench.Measure(BenchShaft(), kWristDirection | kTip, 0.0);
  ShaftEstimator estimator(BenchOptions());
  Measurements bad = z;
  bad.tip->p_RE.x() = std::nan("");
  EXPECT_EQ(estimator.Update(bad).status, EstimateStatus::kBadInput);
  EstimatorOptions far = BenchOptions();
  far.p_RP = {0.9, 0, 0};
  EXPECT_EQ(ShaftEstimator(far).Update(z).status, EstimateStatus::kNotConverged);
  EXPECT_EQ(estimator.Update(z).status, EstimateStatus::kOk);
}

TEST(ShaftEstimator, FindsTheTissuesStiffness) {
  SensorBench bench;
  ShaftEstimator estimator(BenchOptions());
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();
  K(1, 1) = -60.0;
  const RodState start = RodSolver().Solve(
      {kBenchLength, kBenchStiffness, {0, 0, 0}, kBenchPort, {0, 0, 0}, {0, 0, 0}});
  ShaftEstimate e;
  for (int i = 0; i < 40; ++i) {
    RodProblem problem = BenchShaft();
    problem.f_tip.setZero();
    problem.p_wrist = {0, 0.0015 * i, 0};  // the tip goes down into the tissue
    RodSolver solver;
    for (int j = 0; j < 200; ++j) {
      const Eigen::Vector3d f = K * (solver.Solve(problem).tip.p - start.tip.p);
      problem.f_tip += 0.1 * (f - problem.f_tip);
    }
    e = estimator.Update(bench.Measure(problem, kWristDirection | kTip | kEm, 0.2));
  }
  // Shrunk by a fifth on purpose after 12 mm of travel: too stiff a belief is what makes the loop
  // overshoot. The noise of the secants is a tenth (one standard deviation).
  EXPECT_LT(e.model.tissue_stiffness_N_m(1, 1), -60.0 * 0.8 * 0.7);
  EXPECT_GT(e.model.tissue_stiffness_N_m(1, 1), -60.0 * 1.1);
}

/// The derivatives of every sensor's residuals, with all that may act on the shaft and without.
class RodFitDerivatives : public testing::TestWithParam<bool> {};

TEST_P(RodFitDerivatives, AgreeWithDifferences) {
  SensorBench bench;
  const Measurements z = bench.Measure(BenchShaft(), 127, 1.0);
  RodPrior prior;
  prior.mean << z.p_RW, kBenchPort, Eigen::Vector3d::Zero();
  prior.sd << Eigen::Vector3d::Constant(5e-5), Eigen::Vector3d::Constant(3e-4), 4, 4, 4;
  ShaftRod solver;
  ShaftProblem shaft;
  shaft.rod.rod.length_m = kBenchLength;
  shaft.rod.rod.bending_stiffness_Nm2 = kBenchStiffness;
  if (GetParam()) {
    RodEffects& effects = shaft.rod.effects;
    effects.y_wrist = z.R_RW->col(1);
    effects.curvature_1_m = {0.15, -0.1};
    effects.port_compliance_m_N = 4e-4;
    effects.wrist_compliance_m_N = 3e-4;
    effects.port_couple_Nm = {0.1, 0.02, -0.01};
    effects.port_friction = -0.2;
    effects.q_inside_N_m = {0.1, 0.3, -0.2};
    shaft.tip_compliance_m_N = 5e-4;
  }
  const RodFit fit(shaft, z, prior, true, solver);
  RodParameters x = prior.mean;
  x.tail<3>() = kBenchForce / fit.ForceUnit();
  RodFit::Residuals r;
  RodFit::Jacobian J;
  ASSERT_TRUE(fit(x.data(), r.data(), J.data()));
  EXPECT_EQ(fit.MeasurementCount(), 2 + 3 + 2 + 5 + 2 + 4 + 3);
  const auto f = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    RodFit::Residuals residuals;
    EXPECT_TRUE(fit(at.data(), residuals.data(), nullptr));
    return residuals;
  };
  const Eigen::MatrixXd numeric = NumericJacobian(f, x, 1e-5);
  for (int i = 0; i < J.rows(); ++i) {
    EXPECT_LT((J.row(i) - numeric.row(i)).norm(), 1e-5 * (numeric.row(i).norm() + 1e-3)) << i;
  }
}
INSTANTIATE_TEST_SUITE_P(PlainAndWithEffects, RodFitDerivatives, testing::Bool());

/// The rod with an effect so small that it does nothing, against the plain solver: one answer.
TEST(ShaftRod, BothSolversAgree) {
  ShaftProblem plain;
  plain.rod.rod = BenchShaft();
  plain.rod.rod.q_weight = {0.0, 0.0, -0.3};
  ShaftProblem other = plain;
  other.rod.effects.wrist_compliance_m_N = 1e-15;
  const RodStation stations[3] = {{0.12, false}, {0.02, true}, {0.0, true}};
  ShaftRod a, b;
  const ShaftRodState x = a.Solve(plain, stations), y = b.Solve(other, stations);
  ASSERT_TRUE(x.IsUsable() && y.IsUsable());
  EXPECT_FALSE(x.has_axes);
  EXPECT_TRUE(y.has_axes);
  EXPECT_NEAR(x.s_port_m, y.s_port_m, 1e-9);
  EXPECT_LT((x.p_RE - y.p_RE).norm(), 1e-9);
  EXPECT_LT((x.dp_RE - y.dp_RE).norm(), 1e-6 * x.dp_RE.norm());
  EXPECT_LT((x.t_port - y.t_port).norm(), 1e-8);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((x.stations[i].p - y.stations[i].p).norm(), 1e-9) << i;
    EXPECT_LT((x.stations[i].t - y.stations[i].t).norm(), 1e-8) << i;
    EXPECT_LT((x.stations[i].m - y.stations[i].m).norm(), 1e-8) << i;
    EXPECT_LT((x.stations[i].dm - y.stations[i].dm).norm(), 1e-5) << i;
  }
  EXPECT_LT((x.stations[2].p - x.end.p).norm(), 1e-12);
}

/// A taper alone is a matter of the effects' solver, whatever axes the instrument has.
TEST(ShaftRod, TakesATaper) {
  ShaftProblem tapered;
  tapered.rod.rod = BenchShaft();
  tapered.rod.rod.stiffness_taper = -0.4;
  ShaftProblem other = tapered;
  other.rod.effects.y_wrist = {0.1, 0.5, 0.8};
  other.rod.effects.wrist_compliance_m_N = 1e-15;
  const RodStation stations[2] = {{0.12, false}, {0.02, true}};
  ShaftRod a, b;
  const ShaftRodState x = a.Solve(tapered, stations), y = b.Solve(other, stations);
  ASSERT_TRUE(x.IsUsable() && y.IsUsable());
  EXPECT_FALSE(x.has_axes);
  EXPECT_LT((x.p_RE - y.p_RE).norm(), 1e-9);
  EXPECT_LT((x.dp_RE - y.dp_RE).norm(), 1e-6 * x.dp_RE.norm());
  EXPECT_LT((x.stations[0].m - y.stations[0].m).norm(), 1e-8);
  ShaftProblem constant = tapered;
  constant.rod.rod.stiffness_taper = 0;
  EXPECT_GT((x.p_RE - a.Solve(constant, stations).p_RE).norm(), 1e-4);
  // Turned so that the wrist's y axis, as it is where nobody knows it, lies along the shaft.
  const Eigen::Matrix3d R = ExpRotation({0, 0, M_PI / 2});
  ShaftProblem turned = tapered;
  for (Eigen::Vector3d* v : {&turned.rod.rod.p_wrist, &turned.rod.rod.p_port, &turned.rod.rod.f_tip,
                             &turned.rod.rod.q_weight}) {
    *v = R * *v;
  }
  const ShaftRodState z = b.Solve(turned, stations);
  ASSERT_TRUE(z.IsUsable());
  EXPECT_LT((z.p_RE - R * x.p_RE).norm(), 1e-9);
  RodProblem plain = tapered.rod.rod;
  EXPECT_EQ(RodSolver().Solve(plain).status, RodStatus::kBadInput);
}

TEST(ShaftRod, TipComplianceMovesTheTipAndNotTheShaft) {
  ShaftProblem problem;
  problem.rod.rod = BenchShaft();
  ShaftRod solver;
  const ShaftRodState stiff = solver.Solve(problem);
  problem.tip_compliance_m_N = 1e-3;
  const ShaftRodState soft = solver.Solve(problem);
  EXPECT_LT((stiff.end.p - soft.end.p).norm(), 1e-10);
  EXPECT_LT((soft.p_RE - stiff.p_RE - 1e-3 * kBenchForce).norm(), 1e-10);
  const Eigen::Matrix3d more = (soft.dp_RE - stiff.dp_RE).rightCols<3>();
  EXPECT_LT((more - 1e-3 * Eigen::Matrix3d::Identity()).norm(), 1e-9);
}

/// Measured on a rod with effects, estimated with and without knowing of them.
TEST(ShaftEstimator, FindsTheTipOfAShaftWhoseEffectsAreKnown) {
  ShaftProblem truth;
  truth.rod.rod = BenchShaft();
  truth.rod.rod.bending_stiffness_Nm2 *= 0.8;
  truth.rod.rod.length_m += 0.004;
  truth.rod.rod.p_port += Eigen::Vector3d(0.0, 0.003, -0.002);
  truth.rod.effects.curvature_1_m = {0.1, 0.05};
  truth.rod.effects.port_couple_Nm = {0.1, 0.0, 0.0};
  truth.tip_compliance_m_N = 5e-4;
  ShaftRod solver;
  const ShaftRodState rod = solver.Solve(truth);
  ASSERT_TRUE(rod.IsUsable());
  Measurements z;
  z.wrist_position_noise_m = 5e-5;
  z.wrist_orientation_noise_rad = 3e-4;
  z.R_RW.emplace();
  z.R_RW->col(0) = rod.wrist.t;
  z.R_RW->col(1) = rod.wrist.y;
  z.R_RW->col(2) = rod.wrist.t.cross(rod.wrist.y);
  z.load = LoadMeasurement{kBenchForce, 0.005};
  ShaftChange change;
  change.stiffness_scale = 0.8;
  change.length_delta_m = 0.004;
  change.port_shift_m = {0.0, 0.003, -0.002};
  change.effects = truth.rod.effects;
  change.effects.y_wrist = rod.wrist.y;
  change.tip_compliance_m_N = 5e-4;
  const ShaftEstimate known = ShaftEstimator(BenchOptions(false)).Update(z, change);
  ASSERT_EQ(known.status, EstimateStatus::kOk);
  EXPECT_LT((known.p_RE - rod.p_RE).norm(), 1e-6);  // the force's prior pulls a little
  EXPECT_DOUBLE_EQ(known.model.instrument.length_m, kBenchLength + 0.004);
  const ShaftEstimate nominal = ShaftEstimator(BenchOptions(false)).Update(z);
  EXPECT_GT((nominal.p_RE - rod.p_RE).norm(), 5e-3);
}

}  // namespace
}  // namespace flextip
