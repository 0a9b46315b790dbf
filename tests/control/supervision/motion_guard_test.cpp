// The watched worst angle beside the search over the whole ellipsoid.
#include "control/supervision/motion_guard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "control/supervision/worst_motion.h"
#include "core/draw_vector.h"

namespace flextip {
namespace {

ShaftEstimate Pressed(double force_sd_N) {
  ShaftEstimate estimate;
  estimate.status = EstimateStatus::kOk;
  estimate.model.instrument.length_m = 0.6;
  estimate.model.instrument.bending_stiffness_Nm2 = 0.304;
  estimate.model.p_RP = {0.0, 0.0, 0.17};
  estimate.model.f_tip_N = {0.0, 0.03, 0.05};
  estimate.model.force_known = true;
  estimate.covariance.diagonal().head<6>().setConstant(1e-8);
  estimate.covariance.diagonal().tail<3>().setConstant(force_sd_N * force_sd_N);
  return estimate;
}

const Eigen::Vector3d kWrist(-0.2457, 0.0, 0.3421);

Eigen::Matrix3d StraightJacobian(const ShaftEstimate& estimate) {
  ControllerOptions options;
  options.kind = ControllerKind::kStraightTrack;
  ControlInput input;
  input.p_RW = kWrist;
  input.p_RE_measured = input.p_RE_desired = {0.2457, 0.0, -0.002};
  input.tip_measured = true;
  input.model = estimate.model;
  return TipController(options).Step(input).J_tip_wrist;
}

TEST(MotionGuard, IsBetweenTheEstimatesAngleAndTheSearchOverTheEllipsoid) {
  const ControllerOptions options;
  for (const double force_sd_N : {1e-4, 0.01, 0.03}) {
    const ShaftEstimate estimate = Pressed(force_sd_N);
    const Eigen::Matrix3d J_hat = StraightJacobian(estimate);
    MotionGuard guard(2.0, options.max_tissue_gain, 30.0);
    guard.Update(estimate, kWrist);
    const double watched = guard.WorstAngle(J_hat);
    const WorstMotion worst = FindWorstMotion(J_hat, estimate, kWrist, options, 2.0);
    ASSERT_TRUE(worst.found);
    EXPECT_GE(watched, worst.angle_at_estimate_rad * 0.97) << force_sd_N;
    EXPECT_LE(watched, worst.angle_rad * 1.001) << force_sd_N;
    EXPECT_GE(watched, 0.8 * worst.angle_rad) << force_sd_N;
  }
}

TEST(MotionGuard, FasterCyclesSeeTheSameAnglesLater) {
  const ControllerOptions options;
  const ShaftEstimate estimate = Pressed(0.03);
  const Eigen::Matrix3d J_hat = StraightJacobian(estimate);
  MotionGuard slow(2.0, options.max_tissue_gain, 30.0), fast(2.0, options.max_tissue_gain, 1000.0);
  for (int i = 0; i < 9; ++i) fast.Update(estimate, kWrist);
  slow.Update(estimate, kWrist);
  EXPECT_NEAR(fast.WorstAngle(J_hat), slow.WorstAngle(J_hat), 1e-6);
}

TEST(MotionGuard, AForceThatNobodyKnowsIsTakenAsAShaftIsUsed) {
  const ControllerOptions options;
  const ShaftEstimate estimate = Pressed(3.4);  // the estimator's prior: the shaft would buckle
  const Eigen::Matrix3d J_hat = StraightJacobian(estimate);
  MotionGuard guard(2.0, options.max_tissue_gain, 30.0);
  guard.Update(estimate, kWrist);
  EXPECT_LT(guard.WorstAngle(J_hat), 1.2);
  EXPECT_GT(FindWorstMotion(J_hat, estimate, kWrist, options, 2.0).angle_rad, 3.1);
}

TEST(MotionGuard, AJacobianThatPointsTheWrongWayIsAtNinetyDegreesAndMore) {
  const ShaftEstimate estimate = Pressed(0.01);
  MotionGuard guard(2.0, 1.7, 30.0);
  EXPECT_EQ(guard.WorstAngle(StraightJacobian(estimate)), 0.0);  // nothing was seen yet
  guard.Update(estimate, kWrist);
  EXPECT_GT(guard.WorstAngle(-StraightJacobian(estimate)), 1.6);
  EXPECT_GT(guard.WorstAngle(Eigen::Matrix3d::Constant(std::nan(""))), 3.1);
}

TEST(MotionGuard, TheWorstStepsAngleIsTheWorstAngle) {
  const ShaftEstimate estimate = Pressed(0.03);
  const Eigen::Matrix3d J_hat = StraightJacobian(estimate);
  MotionGuard guard(2.0, 1.7, 30.0);
  guard.Update(estimate, kWrist);
  const double worst = guard.WorstAngle(J_hat);
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  double largest = 0.0, least = 10.0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d wanted = DrawVector<3>(normal, rng);
    const double angle = guard.StepAngle(wanted, J_hat.inverse() * wanted);
    largest = std::max(largest, angle);
    least = std::min(least, angle);
  }
  EXPECT_LE(largest, worst + 1e-9);
  EXPECT_GT(largest, 0.98 * worst);
  EXPECT_LT(least, 0.7 * worst);  // most steps are better off
}

}  // namespace
}  // namespace flextip
