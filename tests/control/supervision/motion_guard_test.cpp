// The watched worst angle beside the search over the whole ellipsoid.
#include "control/supervision/motion_guard.h"

#include <gtest/gtest.h>

#include <cmath>

#include "control/supervision/worst_motion.h"

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
    const double watched = guard.Update(J_hat, estimate, kWrist);
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
  double by_fast = 0.0;
  for (int i = 0; i < 9; ++i) by_fast = fast.Update(J_hat, estimate, kWrist);
  EXPECT_NEAR(by_fast, slow.Update(J_hat, estimate, kWrist), 1e-6);
}

TEST(MotionGuard, AForceThatNobodyKnowsIsTakenAsAShaftIsUsed) {
  const ControllerOptions options;
  const ShaftEstimate estimate = Pressed(3.4);  // the estimator's prior: the shaft would buckle
  const Eigen::Matrix3d J_hat = StraightJacobian(estimate);
  MotionGuard guard(2.0, options.max_tissue_gain, 30.0);
  EXPECT_LT(guard.Update(J_hat, estimate, kWrist), 1.2);
  EXPECT_GT(FindWorstMotion(J_hat, estimate, kWrist, options, 2.0).angle_rad, 3.1);
}

TEST(MotionGuard, AJacobianThatPointsTheWrongWayIsAtNinetyDegreesAndMore) {
  const ShaftEstimate estimate = Pressed(0.01);
  MotionGuard guard(2.0, 1.7, 30.0);
  EXPECT_GT(guard.Update(-StraightJacobian(estimate), estimate, kWrist), 1.6);
  EXPECT_EQ(guard.Update(Eigen::Matrix3d::Constant(std::nan("")), estimate, kWrist), 0.0);
}

}  // namespace
}  // namespace flextip
