#include <gtest/gtest.h>

#include "estimation/moment_fit.h"
#include "estimation/shaft_estimator.h"
#include "estimation/three_slope_fit.h"
#include "kinematics/arm.h"
#include "kinematics/joint_step.h"
#include "kinematics/straight.h"
#include "tests/control/allocation_counter.h"
#include "tests/estimation/beam_truth.h"

namespace flextip {
namespace {

// All that a control step may call of straight shaft, beam, fits and arms.
TEST(BeamAllocation, NothingInsideAControlStepAllocates) {
  const BeamTruth truth;
  const SlopeNoise noise{.wrist_rad = 1e-3, .port_rad = 1e-3, .tip_rad = 1e-3};
  const Eigen::Vector3d p_RE = truth.Tip(), t_wrist = truth.Direction(0),
                        t_port = truth.Direction(truth.a), t_tip = truth.Direction(truth.L);
  const MomentPair moments{truth.Moment(0.15), truth.Moment(0.5), 0.15, 0.5, 1e-3};
  double sum = 0.0;
  const long before = AllocationCount();
  const ThreeSlopeFit three =
      FitFromThreeSlopes(truth.p_RW, p_RE, t_wrist, t_port, t_tip, truth.L, noise);
  const BeamFit by_moments = FitFromMoments(truth.p_RW, p_RE, moments, truth.EI, truth.L);
  const BeamFit fit = FitFromSlopes(truth.p_RW, p_RE, t_wrist, t_tip, truth.L, noise);
  const Eigen::Vector3d port = BeamPort(fit, truth.p_RW);
  const BeamFit solved =
      SolveBeam(truth.p_RW, port, truth.EI * BeamTipLoad(fit), truth.EI, truth.L);
  JointStepInput<3> input;
  input.p_tip = BeamTip(fit, truth.p_RW);
  input.J_tip_wrist = BeamJacobian(fit, BeamLoadLaw::kTipForce);
  const PhantomArm arm;
  input.theta = arm.Solve({0.01, 0.02, 0.03}).theta;
  input.J_wrist_joints = arm.Jacobian(input.theta);
  sum += JointStep(input).theta_desired.sum() + three.beam.a + by_moments.a + solved.a +
         SolveStraight(truth.p_RW, port, truth.L).p_tip.sum();
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_TRUE(three.beam.IsUsable() && by_moments.IsUsable() && solved.IsUsable());
}

TEST(BeamAllocation, AnEstimateAllocatesNothingWithEffectsAndWithout) {
  EstimatorOptions options;
  options.instrument = {0.6, 0.00238, 0.304, 0.0};
  options.p_RP = {0.28, 0.0, 0.0};
  Measurements z;
  z.R_RW = Eigen::Matrix3d::Identity();
  z.wrist_orientation_noise_rad = 3e-4;
  z.wrist_position_noise_m = 5e-5;
  z.strain.emplace();
  // As a tip force of 0.3 N across the shaft bends it: moments that fit together, so that the fit
  // does not turn on the last bit.
  z.strain->moments_Nm << 0.0123, 0.0411, 0.009, 0.03;
  z.strain->station_from_wrist_m[0] = 0.12;
  z.strain->station_from_wrist_m[1] = 0.5;
  z.strain->moment_noise_Nm = 8e-4;
  ShaftChange bent;
  bent.effects.curvature_1_m = {0.05, 0.02};
  bent.tip_compliance_m_N = 1e-4;
  for (const ShaftChange& change : {ShaftChange(), bent}) {
    ShaftEstimator estimator(options);
    estimator.Update(z, change);
    const long before = AllocationCount();
    const ShaftEstimate estimate = estimator.Update(z, change);
    EXPECT_EQ(AllocationCount(), before);
    EXPECT_EQ(estimate.status, EstimateStatus::kOk);
  }
}

}  // namespace
}  // namespace flextip
