// The estimate is the least squares of its own residuals: against a damped fit that starts at the
// truth, has many more iterations and no warm start.
#include <ceres/tiny_solver.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "core/draw_vector.h"
#include "estimation/rod_fit.h"
#include "sensor_bench.h"

namespace flextip {
namespace {

/// Returns the least sum of squares that a damped fit from the truth finds.
double LeastSquares(const Measurements& z, const RodProblem& truth, bool use_positions) {
  const EstimatorOptions options = BenchOptions(use_positions);
  RodPrior prior;
  prior.mean << z.p_RW, options.p_RP, Eigen::Vector3d::Zero();
  prior.sd << Eigen::Vector3d::Constant(z.wrist_position_noise_m),
      Eigen::Vector3d::Constant(options.port_prior_m),
      Eigen::Vector3d::Constant(options.force_prior_units);
  ShaftProblem shaft;
  shaft.rod.rod = truth;
  ShaftRod solver;
  RodFit fit(shaft, z, prior, use_positions, solver);
  RodParameters x;
  x << truth.p_wrist, truth.p_port, truth.f_tip / fit.ForceUnit();
  ceres::TinySolver<RodFit> damped;
  damped.options.max_num_iterations = 200;
  damped.options.cost_threshold = 0.0;
  damped.options.gradient_tolerance = 1e-10;
  damped.options.parameter_tolerance = 1e-14;
  damped.Solve(fit, &x);
  RodFit::Residuals r;
  return fit(x.data(), r.data(), nullptr) ? r.squaredNorm() : -1.0;
}

TEST(ShaftEstimator, EndsAtTheLeastSquares) {
  std::mt19937_64 rng(77);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  SensorBench bench;
  int fits = 0, beyond = 0;
  double worst = 0.0;
  for (const SensorSet& set : kSets) {
    ShaftEstimator carried(BenchOptions(set.use_positions));  // starts each fit at the last load
    for (int i = 0; i < 250; ++i) {
      RodProblem truth = BenchShaft();
      truth.f_tip = 2.0 * DrawVector<3>(uniform, rng);
      truth.p_wrist = 0.02 * DrawVector<3>(uniform, rng);
      truth.p_port += 0.002 * DrawVector<3>(uniform, rng);
      const double noise = i % 3 == 0 ? 1.0 : i % 3 == 1 ? 0.0 : 5.0;  // in stated deviations
      const Measurements z = bench.Measure(truth, set.sensors, noise);
      const double least = LeastSquares(z, truth, set.use_positions);
      ASSERT_GE(least, 0.0);
      ShaftEstimator fresh(BenchOptions(set.use_positions));
      for (ShaftEstimator* estimator : {&fresh, &carried}) {
        const ShaftEstimate estimate = estimator->Update(z);
        ASSERT_TRUE(estimate.covariance.allFinite()) << set.name << i;
        const double miss = (estimate.chi2 - least) / (1.0 + least);
        worst = std::max(worst, miss);
        ++fits;
        if (miss > 1e-5) {
          ++beyond;
          if (beyond % 8 == 1)
            std::printf("%s, %s, noise %g: %g over %g, %s\n", set.name,
                        estimator == &fresh ? "fresh" : "carried", noise, estimate.chi2, least,
                        Name(estimate.status));
        }
      }
    }
  }
  std::printf("%d fits, %d beyond the least squares, by %.1e at most\n", fits, beyond, worst);
  EXPECT_EQ(beyond, 0);
}

}  // namespace
}  // namespace flextip
