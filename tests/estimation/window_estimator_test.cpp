#include "estimation/window_estimator.h"

#include <gtest/gtest.h>

#include <random>

#include "../control/allocation_counter.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip {
namespace {

constexpr double kL = 0.6, kEI = 0.304, kWrist_m = 5e-5, kWristAngle_rad = 3e-4;
const Eigen::Vector3d kPort(0.28, 0.0, 0.0);
const Eigen::Vector3d kSight = Eigen::Vector3d(-0.3, 0.2, 0.9).normalized();

/// What a wrist pose and a camera say of the exact rod while the wrist wanders and the force on the
/// tip changes with every sample.
class Wandering {
 public:
  explicit Wandering(unsigned seed) : rng_(seed) {}

  Eigen::Vector3d p_port = kPort;  // true
  bool wrist_turns = true;         // measured: its orientation
  double force_N = 0.4;
  RodState rod;

  Measurements Next() {
    RodProblem problem{kL, kEI, 0.02 * Normal(), p_port, force_N * Normal(), {0, 0, 0}};
    rod = RodSolver().Solve(problem);
    EXPECT_TRUE(rod.IsUsable());
    Measurements z;
    z.p_RW = problem.p_wrist + kWrist_m * Normal();
    z.wrist_position_noise_m = kWrist_m;
    if (wrist_turns) {
      z.R_RW = ExpRotation(kWristAngle_rad * Normal()) *
               RotationWithoutTwist(Eigen::Vector3d::UnitX(), rod.wrist.t);
      z.wrist_orientation_noise_rad = kWristAngle_rad;
    }
    const Eigen::Matrix3d root =
        1e-4 * Eigen::Matrix3d::Identity() + 4e-4 * kSight * kSight.transpose();
    z.tip.emplace();
    z.tip->status = TipStatus::kOk;
    z.tip->covariance_m2 = root * root;
    z.tip->p_RE = rod.tip.p + root * Normal();
    return z;
  }

  Eigen::Vector3d Normal() { return {normal_(rng_), normal_(rng_), normal_(rng_)}; }

 private:
  std::mt19937 rng_;
  std::normal_distribution<double> normal_;
};

WindowOptions Options(double port_prior_m = 0.004) {
  WindowOptions options;
  options.estimator.instrument = {kL, 0.00238, kEI, 0.0};
  options.estimator.p_RP = kPort;
  options.estimator.port_prior_m = port_prior_m;
  return options;
}

TEST(WindowEstimator, FindsAPortSeveralMillimetresOffByVisionAndTheWristAlone) {
  double by_window = 0.0, by_trust = 0.0, by_truth = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Wandering shaft(seed);
    shaft.p_port += Eigen::Vector3d(0.0, 0.004, -0.003);
    WindowEstimator window(Options());
    WindowEstimate e;
    for (int i = 0; i < 40; ++i) e = window.Update(shaft.Next());
    EXPECT_EQ(e.status, WindowStatus::kOk);
    EXPECT_EQ(e.samples, 30);
    const Eigen::Vector3d miss = kPort + e.port_shift_m - shaft.p_port;
    EXPECT_LT(miss.tail<2>().norm(), 4e-4) << seed;  // along the shaft it is not known
    // One sample that trusts the registration is wrong; one that is told the port does best.
    ShaftEstimator trusting(Options(0.0003).estimator);
    EstimatorOptions known = Options(0.0003).estimator;
    known.p_RP = shaft.p_port;
    ShaftEstimator told(known);
    for (int i = 0; i < 15; ++i) {
      const Measurements z = shaft.Next();
      by_window += (window.Update(z).shaft.d_RE - shaft.rod.tip.t).squaredNorm();
      by_trust += (trusting.Update(z).d_RE - shaft.rod.tip.t).squaredNorm();
      by_truth += (told.Update(z).d_RE - shaft.rod.tip.t).squaredNorm();
    }
  }
  // Squared error of the direction. What is left of the port costs little beside the tip's noise.
  EXPECT_LT(by_window, 1.5 * by_truth);
  EXPECT_LT(by_window, 0.25 * by_trust);
}

TEST(WindowEstimator, CovarianceOfThePortMatchesMonteCarlo) {
  double nees = 0.0, tip = 0.0;
  const int runs = 60;
  for (int run = 0; run < runs; ++run) {
    Wandering shaft(100 + run);
    shaft.p_port += 0.004 * shaft.Normal();
    WindowEstimator window(Options());
    WindowEstimate e;
    for (int i = 0; i < 12; ++i) e = window.Update(shaft.Next());
    const Eigen::Vector3d miss = kPort + e.port_shift_m - shaft.p_port;
    nees += MahalanobisSquared(miss, e.port_covariance_m2) / runs;
    const Eigen::Vector3d off = e.shaft.p_RE - shaft.rod.tip.p;
    tip += MahalanobisSquared(off, e.shaft.p_RE_covariance_m2) / runs;
  }
  // The mean of chi2 with 3 degrees of freedom over 60 runs: 3 +- 0.32.
  EXPECT_GT(nees, 2.1);
  EXPECT_LT(nees, 3.9);
  EXPECT_GT(tip, 2.1);
  EXPECT_LT(tip, 3.9);
}

TEST(WindowEstimator, SaysThatThePortCannotBeSeenWithoutTheWristsDirection) {
  Wandering shaft(2);
  shaft.wrist_turns = false;
  shaft.force_N = 0.05;  // a strong bend is shorter from wrist to tip: that would tell
  shaft.p_port += Eigen::Vector3d(0.0, 0.003, 0.0);
  WindowEstimator window(Options());
  WindowEstimate e;
  for (int i = 0; i < 30; ++i) e = window.Update(shaft.Next());
  EXPECT_EQ(e.status, WindowStatus::kUnobservable);
  EXPECT_NEAR(e.least_known.norm(), 1.0, 1e-12);
  EXPECT_LT(std::abs(e.least_known.x()), 0.2);  // across the shaft
  EXPECT_GT(e.least_known_sd_m, 0.002);
}

TEST(WindowEstimator, KeepsSamplesThatAreSpread) {
  // A wrist that wanders and then stands still: what it saw on the way is not forgotten.
  Wandering shaft(3);
  WindowEstimator window(Options());
  WindowEstimate moved, stood;
  for (int i = 0; i < 30; ++i) moved = window.Update(shaft.Next());
  const Measurements still = shaft.Next();
  for (int i = 0; i < 100; ++i) stood = window.Update(still);
  EXPECT_LT(stood.least_known_sd_m, 1.1 * moved.least_known_sd_m);
}

TEST(WindowEstimator, OneSampleIsTheShaftEstimatorsAnswer) {
  Wandering shaft(4);
  const Measurements z = shaft.Next();
  const WindowEstimate window = WindowEstimator(Options()).Update(z);
  const ShaftEstimate single = ShaftEstimator(Options().estimator).Update(z);
  EXPECT_LT((window.shaft.p_RE - single.p_RE).norm(), 1e-12);
  // Both minimise the same sum, so they put the port in the same place.
  EXPECT_LT((kPort + window.port_shift_m - single.model.p_RP).norm(), 2e-6);
  const Eigen::Matrix3d covariance = single.covariance.block<3, 3>(3, 3);
  EXPECT_LT((window.port_covariance_m2 - covariance).norm(), 1e-3 * covariance.norm());
}

TEST(WindowEstimator, SurvivesWhatCannotBe) {
  Wandering shaft(5);
  WindowEstimator window(Options());
  for (int i = 0; i < 10; ++i) window.Update(shaft.Next());
  Measurements bad = shaft.Next();
  bad.tip->p_RE.x() = std::nan("");
  EXPECT_EQ(window.Update(bad).shaft.status, EstimateStatus::kBadInput);
  Measurements far = shaft.Next();
  far.p_RW.x() = -0.5;  // the port out of reach
  const WindowEstimate e = window.Update(far);
  EXPECT_EQ(e.shaft.status, EstimateStatus::kNotConverged);
  EXPECT_EQ(e.samples, 10);
  EXPECT_TRUE(e.port_shift_m.allFinite() && e.port_covariance_m2.allFinite());
  EXPECT_EQ(window.Update(shaft.Next()).shaft.status, EstimateStatus::kOk);
  window.Reset();
  EXPECT_EQ(window.Update(shaft.Next()).samples, 1);
  WindowOptions nowhere = Options();
  nowhere.estimator.p_RP.x() = 0.9;
  EXPECT_EQ(WindowEstimator(nowhere).Update(shaft.Next()).status, WindowStatus::kNotConverged);
}

TEST(WindowEstimator, AnUpdateAllocatesNothing) {
  Wandering shaft(6);
  WindowEstimator window(Options());
  for (int i = 0; i < 40; ++i) window.Update(shaft.Next());
  for (int i = 0; i < 30; ++i) {
    const Measurements z = shaft.Next();
    const long before = AllocationCount();
    window.Update(z);
    EXPECT_EQ(AllocationCount(), before);
  }
}

}  // namespace
}  // namespace flextip
