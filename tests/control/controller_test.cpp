#include "control/controller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "allocation_counter.h"
#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "kinematics/straight.h"

namespace flextip {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Chapter 4's shaft: 2 N hung at the tip.
ControlInput Chapter4Input() {
  ControlInput input;
  input.model.instrument = {0.6, 0.00238, 0.304, 0.0};
  input.model.p_RP = {0.28, 0.0, 0.0};
  input.model.f_tip_N = {0.0, -2.0, 0.0};
  input.model.force_known = true;
  input.model.beam = SolveBeam(input.p_RW, input.model.p_RP, input.model.f_tip_N, 0.304, 0.6);
  const RodState rod =
      RodSolver().Solve({0.6, 0.304, input.p_RW, input.model.p_RP, input.model.f_tip_N, {0, 0, 0}});
  input.p_RE_measured = rod.tip.p;
  input.tip_measured = true;
  input.p_RE_desired = rod.tip.p + Eigen::Vector3d(0.001, 0.0005, -0.0007);
  return input;
}

std::vector<ControllerKind> AllKinds() {
  std::vector<ControllerKind> kinds;
  for (int i = 0; i < kControllerKinds; ++i) kinds.push_back(static_cast<ControllerKind>(i));
  return kinds;
}

ControllerOptions Options(ControllerKind kind) {
  ControllerOptions options;
  options.kind = kind;
  return options;
}

TEST(Controller, NamesRoundTrip) {
  for (const ControllerKind kind : AllKinds()) EXPECT_EQ(ControllerKindNamed(Name(kind)), kind);
  EXPECT_FALSE(ControllerKindNamed("bent-track"));
}

TEST(Controller, StepSolvesTheJacobianForTheTipError) {
  for (const ControllerKind kind : AllKinds()) {
    const ControlInput input = Chapter4Input();
    const ControlOutput out = TipController(Options(kind)).Step(input);
    ASSERT_EQ(out.status, ControlStatus::kOk) << Name(kind);
    // The tip that was used, by what the kind says it uses.
    if (UsesTipMeasurement(kind)) {
      EXPECT_EQ(out.p_RE_used, input.p_RE_measured);
    }
    if (out.damped || out.step_limited) continue;
    const Eigen::Vector3d moved = out.J_tip_wrist * (out.p_RW_command - input.p_RW);
    EXPECT_LT((moved - (input.p_RE_desired - out.p_RE_used)).norm(), 1e-12) << Name(kind);
  }
}

TEST(Controller, RodTrackReachesTheGoalOnTheRodInTwoSteps) {
  ControlInput input = Chapter4Input();
  TipController controller(Options(ControllerKind::kRodTrack));
  for (int i = 0; i < 2; ++i) {
    input.p_RW = controller.Step(input).p_RW_command;
    input.p_RE_measured =
        RodSolver()
            .Solve({0.6, 0.304, input.p_RW, input.model.p_RP, input.model.f_tip_N, {0, 0, 0}})
            .tip.p;
  }
  EXPECT_LT((input.p_RE_measured - input.p_RE_desired).norm(), 1e-6);
}

/// At 120 Hz a correction takes four steps' time: each makes a quarter of the rest of it.
TEST(Controller, AFastStepMakesAPartOfACorrection) {
  for (const ControllerKind kind : AllKinds()) {
    ControlInput input = Chapter4Input();
    const Eigen::Vector3d p_whole = TipController(Options(kind)).Step(input).p_RW_command;
    ControllerOptions options = Options(kind);
    options.rate_hz = 120.0;
    input.last = {input.p_RW, input.p_RE_desired};
    const Eigen::Vector3d p = TipController(options).Step(input).p_RW_command;
    EXPECT_LT((p - (input.p_RW + 0.25 * (p_whole - input.p_RW))).norm(), 1e-15) << Name(kind);
    // Where steps are seldom, and where the first one is made, all of it.
    options.rate_hz = 30.0;
    EXPECT_EQ(TipController(options).Step(input).p_RW_command, p_whole) << Name(kind);
    options.rate_hz = 120.0;
    input.last.reset();
    EXPECT_EQ(TipController(options).Step(input).p_RW_command, p_whole) << Name(kind);
  }
}

/// The goal's own motion is followed at once: no correction is needed where the tip is at its goal.
TEST(Controller, AFastStepFollowsTheGoalAtOnce) {
  for (const ControllerKind kind : AllKinds()) {
    ControllerOptions options = Options(kind);
    ControlInput input = Chapter4Input();
    const ControlOutput whole = TipController(options).Step(input);
    if (whole.damped) continue;
    options.rate_hz = 1000.0;
    input.last = {input.p_RW, whole.p_RE_used};  // the tip was at its goal
    const Eigen::Vector3d p = TipController(options).Step(input).p_RW_command;
    EXPECT_LT((p - whole.p_RW_command).norm(), 1e-12) << Name(kind);
  }
}

/// The reading's noise goes into every command; a fast loop takes its mean.
TEST(Controller, AFastLoopDoesNotPassOnTheWristsNoise) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> noise(0.0, 50e-6);
  ControllerOptions options = Options(ControllerKind::kRodTrack);
  options.rate_hz = 1000.0;
  TipController controller(options);
  ControlInput input = Chapter4Input();
  input.p_RE_desired = input.p_RE_measured;
  input.last = {input.p_RW, input.p_RE_desired};
  double square_m2 = 0.0;
  constexpr int kSteps = 3000;
  for (int k = 0; k < kSteps; ++k) {
    input.p_RW = DrawVector<3>(noise, random);
    input.last->p_RW = controller.Step(input).p_RW_command;
    square_m2 += input.last->p_RW.squaredNorm() / 3.0;
  }
  // A part g of white noise each time leaves g / (2 - g) of its variance.
  const double g = 30.0 / 1000.0;
  EXPECT_NEAR(std::sqrt(square_m2 / kSteps), 50e-6 * std::sqrt(g / (2.0 - g)), 1e-6);
}

/// Chapter 4's with all that may act on the shaft.
ControlInput InputWithEffects() {
  ControlInput input = Chapter4Input();
  RodEffects& effects = input.model.effects;
  effects.curvature_1_m = {0.1, -0.05};
  effects.port_compliance_m_N = 3e-4;
  effects.wrist_compliance_m_N = 5e-4;
  effects.port_couple_Nm = {0.1, 0.0, 0.02};
  effects.q_inside_N_m = {0.0, 0.3, 0.1};
  input.model.tip_compliance_m_N = 5e-4;
  return input;
}

TEST(Controller, JacobianOfAShaftWithEffectsByDifferences) {
  ControlInput input = InputWithEffects();
  TipController controller(Options(ControllerKind::kRodCalculate));
  const Eigen::Matrix3d J = controller.Step(input).J_tip_wrist;
  const double h = 1e-5;
  for (int i = 0; i < 3; ++i) {
    ControlInput plus = input, minus = input;
    plus.p_RW[i] += h;
    minus.p_RW[i] -= h;
    const Eigen::Vector3d numeric =
        (controller.Step(plus).p_RE_used - controller.Step(minus).p_RE_used) / (2 * h);
    EXPECT_LT((J.col(i) - numeric).norm(), 1e-5) << i;
  }
  // The arm that yields makes the tip follow less, or more, than the rigid one.
  input.model.effects.wrist_compliance_m_N = 0.0;
  EXPECT_GT((controller.Step(input).J_tip_wrist - J).norm(), 1e-3);
}

/// A wrist with play by the play's definition, moved to a goal and back: the controller that leads
/// by the play is there after two steps, the one that does not know of it is still crossing it.
TEST(Controller, LeadsByThePlayOfTheWrist) {
  constexpr double kPlay_m = 0.001;
  // The encoders may misread the wrist besides: that is no play to cross.
  const Eigen::Vector3d misread_m(0.0012, -0.0007, 0.0009), none_m(0.0, 0.0, 0.0);
  for (const auto& [knows, off_m] :
       {std::pair(true, none_m), std::pair(true, misread_m), std::pair(false, none_m)}) {
    ControlInput input = Chapter4Input();
    input.model.wrist_misread_m = off_m;
    const Eigen::Vector3d start = input.p_RE_measured;
    TipController controller(Options(ControllerKind::kRodTrack));
    Eigen::Vector3d wrist = input.p_RW;  // the true one
    input.p_RW -= off_m;
    double worst_m = 0.0;
    for (int i = 0; i < 40; ++i) {
      input.p_RE_desired = start + Eigen::Vector3d(0.0, 0.0, (i / 10) % 2 == 0 ? 0.0005 : 0.0);
      input.model.wrist_play_m = knows ? kPlay_m : 0.0;
      input.model.wrist_shift_m =
          knows ? Eigen::Vector3d(wrist - input.p_RW) : Eigen::Vector3d(0, 0, 0);
      input.p_RW = controller.Step(input).p_RW_command;
      const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * kPlay_m);
      const Eigen::Vector3d driver = input.p_RW + off_m;
      wrist = wrist.cwiseMax(driver - half).cwiseMin(driver + half);
      input.p_RE_measured =
          RodSolver()
              .Solve({0.6, 0.304, wrist, input.model.p_RP, input.model.f_tip_N, {0, 0, 0}})
              .tip.p;
      if (i >= 10 && i % 10 == 1)
        worst_m = std::max(worst_m, (input.p_RE_measured - input.p_RE_desired).norm());
    }
    if (knows) {
      EXPECT_LT(worst_m, 3e-5);
    } else {
      EXPECT_GT(worst_m, 1e-4);
    }
  }
}

TEST(Controller, APlayThatIsNotThereDoesNotMakeTheLoopSwing) {
  ControlInput input = Chapter4Input();
  TipController controller(Options(ControllerKind::kRodTrack));
  Eigen::Vector3d believed = input.p_RW;
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.0005);
  double last_m = 1.0;
  for (int i = 0; i < 60; ++i) {
    input.model.wrist_play_m = 0.001;
    input.model.wrist_shift_m = believed - input.p_RW;
    input.p_RW = controller.Step(input).p_RW_command;
    believed = believed.cwiseMax(input.p_RW - half).cwiseMin(input.p_RW + half);
    input.p_RE_measured =
        RodSolver()
            .Solve({0.6, 0.304, input.p_RW, input.model.p_RP, input.model.f_tip_N, {0, 0, 0}})
            .tip.p;
    last_m = (input.p_RE_measured - input.p_RE_desired).norm();
    EXPECT_LT(last_m, 4e-3) << i;
  }
}

TEST(Controller, StraightJacobianIsTheLeversByDifferences) {
  const ControlInput input = Chapter4Input();
  const auto tip = [&](const Eigen::VectorXd& w) -> Eigen::VectorXd {
    return SolveStraight(w, input.model.p_RP, 0.6).p_tip;
  };
  const ControlOutput out = TipController(Options(ControllerKind::kStraightTrack)).Step(input);
  EXPECT_LT((out.J_tip_wrist - NumericJacobian(tip, input.p_RW, 1e-4)).norm(), 1e-9);
}

TEST(Controller, TrackersHoldStillWithoutATip) {
  for (const ControllerKind kind : AllKinds()) {
    ControlInput input = Chapter4Input();
    input.tip_measured = false;
    input.p_RE_measured.setConstant(kNaN);  // whatever stands there must not be read
    const ControlOutput out = TipController(Options(kind)).Step(input);
    EXPECT_EQ(out.status, UsesTipMeasurement(kind) ? ControlStatus::kNoTip : ControlStatus::kOk);
    EXPECT_TRUE(out.p_RW_command.allFinite());
    if (UsesTipMeasurement(kind)) {
      EXPECT_EQ(out.p_RW_command, input.p_RW);
    }
  }
}

TEST(Controller, TissueIsTrustedOnlySoFar) {
  // Whatever stiffness is believed, the step on a shaft whose tissue let go overshoots less than
  // twice: the loop stays stable.
  std::mt19937_64 rng(9);
  std::normal_distribution<double> normal;
  ControlInput input = Chapter4Input();
  const Eigen::Matrix3d J_free =
      TipController(Options(ControllerKind::kRodTrack)).Step(input).J_tip_wrist;
  for (const double size : {1.0, 30.0, 1000.0}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Matrix3d A = Eigen::Matrix3d::NullaryExpr([&] { return normal(rng); });
      input.model.tissue_stiffness_N_m = -size * A * A.transpose();
      const ControlOutput out = TipController(Options(ControllerKind::kRodTrack)).Step(input);
      const Eigen::Matrix3d loop = J_free * out.J_tip_wrist.inverse();
      const Eigen::Vector3d gains = loop.eigenvalues().cwiseAbs();
      EXPECT_LT(gains.maxCoeff(), 1.7 + 1e-6);
      EXPECT_GT(gains.minCoeff(), 1.0 - 1e-6);
      if (size == 1000.0) {
        EXPECT_GT(gains.maxCoeff(), 1.7 - 1e-6);
      }
    }
  }
}

TEST(Controller, HoldsStillOnBadInputAndWithoutAModel) {
  for (const ControllerKind kind : AllKinds()) {
    ControlInput bad = Chapter4Input();
    bad.p_RE_desired.y() = kNaN;
    ControlOutput out = TipController(Options(kind)).Step(bad);
    EXPECT_EQ(out.status, ControlStatus::kBadInput);
    EXPECT_EQ(out.p_RW_command, bad.p_RW);

    ControlInput far = Chapter4Input();
    far.model.p_RP = {0.7, 0, 0};
    far.model.beam.status = BeamStatus::kNoPort;
    out = TipController(Options(kind)).Step(far);
    EXPECT_EQ(out.status, ControlStatus::kNoModel) << Name(kind);
    EXPECT_EQ(out.p_RW_command, far.p_RW);
  }
}

TEST(Controller, FallsBackOnTheStraightShaftAndSaysSo) {
  for (const ControllerKind kind : AllKinds()) {
    ControlInput input = Chapter4Input();
    input.model.f_tip_N.setZero();
    input.model.force_known = false;
    input.model.beam.status = BeamStatus::kStraight;
    const ControlOutput out = TipController(Options(kind)).Step(input);
    const bool straight =
        kind == ControllerKind::kStraightCalculate || kind == ControllerKind::kStraightTrack;
    EXPECT_EQ(out.status, straight ? ControlStatus::kOk : ControlStatus::kStraightInstead);
    const StraightShaft lever = SolveStraight(input.p_RW, input.model.p_RP, 0.6);
    EXPECT_LT((out.J_tip_wrist - lever.J_tip_wrist).norm(), 1e-9) << Name(kind);
  }
}

TEST(Controller, StepIsBoundedAndSaysSo) {
  for (const ControllerKind kind : AllKinds()) {
    ControlInput input = Chapter4Input();
    input.p_RE_desired += Eigen::Vector3d(0.0, 0.2, 0.0);
    const ControlOutput out = TipController(Options(kind)).Step(input);
    EXPECT_TRUE(out.step_limited);
    EXPECT_NEAR((out.p_RW_command - input.p_RW).norm(), 0.01, 1e-12);
  }
}

TEST(Controller, WristKeepsItsDistanceFromThePort) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  for (const ControllerKind kind : AllKinds()) {
    TipController controller(Options(kind));
    for (int i = 0; i < 200; ++i) {
      ControlInput input = Chapter4Input();
      // Near either end of the shaft, with wild goals.
      input.p_RW = {i % 2 == 0 ? 0.265 : -0.305, 0.002 * normal(rng), 0.002 * normal(rng)};
      input.p_RE_desired += 0.3 * DrawVector<3>(normal, rng);
      const ControlOutput out = controller.Step(input);
      ASSERT_TRUE(out.p_RW_command.allFinite());
      if (out.status == ControlStatus::kNoModel) continue;
      const double distance = (out.p_RW_command - input.model.p_RP).norm();
      EXPECT_GE(distance, 0.0119);
      EXPECT_LE(distance, 0.5881);
    }
  }
}

TEST(Controller, DampsNearSingular) {
  // A wrist almost on the port: the lever (L - a) / a is long one way; a tip almost at the port:
  // its motion across nearly vanishes, and an undamped inverse would throw the wrist about.
  ControlInput input = Chapter4Input();
  input.p_RW = {-0.3, 0, 0};  // the tip 20 mm beyond the port
  input.p_RE_measured = {0.3, 0, 0};
  input.p_RE_desired = input.p_RE_measured + Eigen::Vector3d(0, 0.0001, 0);
  ControllerOptions options = Options(ControllerKind::kStraightTrack);
  const ControlOutput out = TipController(options).Step(input);
  EXPECT_TRUE(out.damped);
  EXPECT_NEAR(out.smallest_singular_value, 0.02 / 0.58, 1e-9);
  options.min_singular_value = 0.01;
  const ControlOutput free = TipController(options).Step(input);
  EXPECT_FALSE(free.damped);
  EXPECT_LT((out.p_RW_command - input.p_RW).norm(), (free.p_RW_command - input.p_RW).norm());
}

TEST(Controller, StepAllocatesNothing) {
  const long empty = AllocationCount();
  const Eigen::MatrixXd dynamic(4, 4);
  ASSERT_EQ(AllocationCount(), empty + (CountsAllocations() ? 1 : 0));
  for (const ControllerKind kind : AllKinds()) {
    TipController controller(Options(kind));
    ControlInput input = InputWithEffects();
    input.model.wrist_play_m = 0.001;
    controller.Step(input);  // cold
    const long before = AllocationCount();
    for (int i = 0; i < 10; ++i) input.p_RW = controller.Step(input).p_RW_command;
    EXPECT_EQ(AllocationCount(), before) << Name(kind);
  }
}

}  // namespace
}  // namespace flextip
