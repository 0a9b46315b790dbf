// Whatever comes in, a controller's command is finite and within its bound
// (docs/notes/robustness_control.md).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "control/controller.h"
#include "control/direction_controller.h"
#include "control/fixtures.h"
#include "core/place.h"
#include "tests/hostile_numbers.h"

namespace flextip {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kHuge = 1e308;

ShaftModel BentShaft() {
  ShaftModel model;
  model.instrument = {0.6, 0.00238, 0.304, 0.02};
  model.p_RP = {0.28, 0.0, 0.0};
  model.f_tip_N = {0.2, -1.2, 0.8};
  model.weight_N_m = {0.0, 0.0, -0.2};
  model.force_known = true;
  model.beam = SolveBeam({0, 0, 0}, model.p_RP, model.f_tip_N, 0.304, 0.6);
  return model;
}

void AddEffects(ShaftModel& model) {
  model.instrument.stiffness_taper = 0.1;
  model.effects.curvature_1_m = {0.1, -0.05};
  model.effects.port_compliance_m_N = 3e-4;
  model.effects.wrist_compliance_m_N = 5e-4;
  model.effects.port_couple_Nm = {0.1, 0.0, 0.02};
  model.effects.port_friction = 0.1;
  model.effects.q_inside_N_m = {0.0, 0.3, 0.1};
  model.tip_compliance_m_N = 5e-4;
  model.wrist_play_m = 0.001;
  model.tissue_stiffness_N_m = Eigen::Vector3d(-4.0, -30.0, -10.0).asDiagonal();
}

ControlInput GoodInput() {
  ControlInput input;
  input.model = BentShaft();
  input.p_RE_measured = {0.598, -0.03, 0.01};
  input.tip_measured = true;
  input.p_RE_desired = input.p_RE_measured + Eigen::Vector3d(0.001, 0.0005, -0.0007);
  return input;
}

DirectionInput GoodDirection() {
  DirectionInput input;
  input.model = BentShaft();
  input.p_RE = {0.598, -0.03, 0.01};
  input.p_RE_desired = input.p_RE + Eigen::Vector3d(0.001, 0.0005, -0.0007);
  input.d_RE_desired = {1.0, 0.01, 0.0};
  return input;
}

void AddNumbersOf(ShaftModel& m, std::vector<double*>& numbers) {
  Instrument& i = m.instrument;
  for (double* number :
       {&i.length_m, &i.bending_stiffness_Nm2, &i.stiffness_taper, &m.tip_compliance_m_N,
        &m.wrist_play_m, &m.effects.port_compliance_m_N, &m.effects.wrist_compliance_m_N,
        &m.effects.port_friction, &m.beam.F_p_over_EI, &m.beam.a, &m.beam.length_m}) {
    numbers.push_back(number);
  }
  for (Eigen::Vector3d* v :
       {&m.p_RP, &m.weight_N_m, &m.f_tip_N, &m.wrist_shift_m, &m.wrist_misread_m,
        &m.effects.y_wrist, &m.effects.port_couple_Nm, &m.effects.q_inside_N_m}) {
    AddNumbers(*v, numbers);
  }
  AddNumbers(m.effects.curvature_1_m, numbers);
  AddNumbers(m.tissue_stiffness_N_m, numbers);
  AddNumbers(m.beam.R_RM, numbers);
}

std::vector<ControllerKind> AllKinds() {
  std::vector<ControllerKind> kinds;
  for (int i = 0; i < kControllerKinds; ++i) kinds.push_back(static_cast<ControllerKind>(i));
  return kinds;
}

bool Moves(ControlStatus status) {
  return status == ControlStatus::kOk || status == ControlStatus::kStraightInstead;
}

/// Expects what must hold of every step.
template <class Output>
void ExpectBounded(const Output& out, const Eigen::Vector3d& p_RW, double max_step_m) {
  ASSERT_TRUE(out.p_RW_command.allFinite());
  if (!p_RW.allFinite()) {
    EXPECT_EQ(out.status, ControlStatus::kBadInput);
    return;
  }
  const double step_m = (out.p_RW_command - p_RW).norm();
  if (!Moves(out.status)) {
    EXPECT_EQ(out.p_RW_command, p_RW);
  } else {
    EXPECT_LE(step_m, max_step_m * (1.0 + 1e-9) + 1e-15 * kFarthestPlace_m) << Name(out.status);
  }
}

struct Case {
  const char* name;
  std::function<void(ShaftModel&)> breaks;
};

// Each was `ok` or `straight_instead` once, with some kind of controller.
const Case kBrokenModels[] = {
    {"length NaN", [](ShaftModel& m) { m.instrument.length_m = kNaN; }},
    {"length 1e6", [](ShaftModel& m) { m.instrument.length_m = 1e6; }},
    {"length 0", [](ShaftModel& m) { m.instrument.length_m = 0.0; }},
    {"stiffness NaN", [](ShaftModel& m) { m.instrument.bending_stiffness_Nm2 = kNaN; }},
    {"stiffness -1", [](ShaftModel& m) { m.instrument.bending_stiffness_Nm2 = -1.0; }},
    {"stiffness 1e30", [](ShaftModel& m) { m.instrument.bending_stiffness_Nm2 = 1e30; }},
    {"taper NaN", [](ShaftModel& m) { m.instrument.stiffness_taper = kNaN; }},
    {"port inf", [](ShaftModel& m) { m.p_RP.y() = kInf; }},
    {"port 1e200", [](ShaftModel& m) { m.p_RP.y() = 1e200; }},
    {"weight NaN", [](ShaftModel& m) { m.weight_N_m.z() = kNaN; }},
    {"weight 1e9", [](ShaftModel& m) { m.weight_N_m.z() = 1e9; }},
    {"force NaN", [](ShaftModel& m) { m.f_tip_N.x() = kNaN; }},
    {"force 1e6", [](ShaftModel& m) { m.f_tip_N.x() = 1e6; }},
    {"tissue NaN", [](ShaftModel& m) { m.tissue_stiffness_N_m(1, 2) = kNaN; }},
    {"tissue 1e300", [](ShaftModel& m) { m.tissue_stiffness_N_m(1, 1) = -1e300; }},
    {"tip compliance NaN", [](ShaftModel& m) { m.tip_compliance_m_N = kNaN; }},
    {"shift NaN", [](ShaftModel& m) { m.wrist_shift_m.x() = kNaN; }},
    {"play NaN", [](ShaftModel& m) { m.wrist_play_m = kNaN; }},
    {"play -1", [](ShaftModel& m) { m.wrist_play_m = -1.0; }},
    {"curvature inf", [](ShaftModel& m) { m.effects.curvature_1_m.x() = kInf; }},
    {"y_wrist NaN", [](ShaftModel& m) { m.effects.y_wrist.x() = kNaN; }},
    {"port compliance NaN", [](ShaftModel& m) { m.effects.port_compliance_m_N = kNaN; }},
    {"couple NaN", [](ShaftModel& m) { m.effects.port_couple_Nm.x() = kNaN; }},
    {"friction 1e9", [](ShaftModel& m) { m.effects.port_friction = 1e9; }},
    {"load inside NaN", [](ShaftModel& m) { m.effects.q_inside_N_m.x() = kNaN; }},
    {"beam force NaN", [](ShaftModel& m) { m.beam.F_p_over_EI = kNaN; }},
    {"beam port beyond", [](ShaftModel& m) { m.beam.a = 0.7; }},
    {"beam length 1e6", [](ShaftModel& m) { m.beam.length_m = 1e6; }},
    {"beam axes 0", [](ShaftModel& m) { m.beam.R_RM.setZero(); }},
};

TEST(HostileControl, ABrokenModelHoldsTheWristStill) {
  for (const Case& c : kBrokenModels) {
    for (const ControllerKind kind : AllKinds()) {
      ControlInput input = GoodInput();
      ControllerOptions options;
      options.kind = kind;
      ASSERT_EQ(TipController(options).Step(input).status, ControlStatus::kOk);
      c.breaks(input.model);
      const ControlOutput out = TipController(options).Step(input);
      EXPECT_EQ(out.status, ControlStatus::kNoModel) << c.name << ", " << Name(kind);
      EXPECT_EQ(out.p_RW_command, input.p_RW);
    }
    DirectionInput input = GoodDirection();
    ASSERT_EQ(DirectionController({}).Step(input).status, ControlStatus::kOk);
    c.breaks(input.model);
    EXPECT_EQ(DirectionController({}).Step(input).status, ControlStatus::kNoModel) << c.name;
  }
}

TEST(HostileControl, AnAbsurdPositionIsBadInput) {
  for (const double wrong : {kNaN, kInf, -kHuge, kHuge, 1e200, 1e6}) {
    for (const ControllerKind kind : AllKinds()) {
      ControllerOptions options;
      options.kind = kind;
      ControlInput input = GoodInput();
      input.p_RE_desired.y() = wrong;
      ControlOutput out = TipController(options).Step(input);
      EXPECT_EQ(out.status, ControlStatus::kBadInput) << wrong << ", " << Name(kind);
      EXPECT_EQ(out.p_RW_command, input.p_RW);
      if (!UsesTipMeasurement(kind)) continue;
      input = GoodInput();
      input.p_RE_measured.y() = wrong;
      out = TipController(options).Step(input);
      EXPECT_EQ(out.status, ControlStatus::kBadInput) << wrong << ", " << Name(kind);
      EXPECT_EQ(out.p_RW_command, input.p_RW);
    }
  }
}

TEST(HostileControl, AWristThatIsNotANumberIsHeldWhereItWas) {
  TipController controller({});
  DirectionController direction({});
  for (const bool known : {false, true}) {
    const Eigen::Vector3d p_RW =
        known ? Eigen::Vector3d(0.01, 0.002, 0.0) : Eigen::Vector3d(0, 0, 0);
    ControlInput input = GoodInput();
    DirectionInput turned = GoodDirection();
    if (known) {
      input.p_RW = turned.p_RW = p_RW;
      controller.Step(input);
      direction.Step(turned);
    }
    input.p_RW.x() = turned.p_RW.x() = kNaN;
    const ControlOutput out = controller.Step(input);
    EXPECT_EQ(out.status, ControlStatus::kBadInput);
    EXPECT_EQ(out.p_RW_command, p_RW);
    EXPECT_EQ(direction.Step(turned).p_RW_command, p_RW);
  }
}

/// Near the port, on it and beyond either end of the shaft, with wild goals.
TEST(HostileControl, NoStepIsLongerThanItsBound) {
  Hostile hostile(5);
  for (const ControllerKind kind : AllKinds()) {
    for (const double max_step_m : {0.0, 1e-6, 0.01, 0.1}) {
      ControllerOptions options;
      options.kind = kind;
      options.max_step_m = max_step_m;
      TipController controller(options);
      for (int i = 0; i < 2000; ++i) {
        ControlInput input = GoodInput();
        const double from_port = i % 3 == 0 ? hostile.Size(-8.0, -1.5) : 0.58 + 0.002 * (i % 15);
        const Eigen::Vector3d aside(0.0, hostile.Size(-9.0, -2.0), hostile.Size(-9.0, -2.0));
        input.p_RW = input.model.p_RP - Eigen::Vector3d(from_port, 0, 0) + aside;
        input.p_RE_desired +=
            Eigen::Vector3d(i % 2 == 0 ? 1.0 : -1.0, 0.2, 0.1) * hostile.Size(-3, 1);
        const ControlOutput out = controller.Step(input);
        ExpectBounded(out, input.p_RW, max_step_m);
      }
    }
  }
}

TEST(HostileControl, NoNumberBreaksATipController) {
  Hostile hostile(11);
  ControllerOptions options;
  TipController controller(options);
  long moved = 0;
  const long trials = HostileTrials(150'000);
  for (long i = 0; i < trials && !HasFailure(); ++i) {
    if (i % 20 == 0) {
      options = {};
      options.kind = static_cast<ControllerKind>(hostile.Below(kControllerKinds));
      options.beam_load_law = hostile.OneIn(2) ? BeamLoadLaw::kTipForce : BeamLoadLaw::kPortForce;
      if (hostile.OneIn(10)) {
        hostile.Break({&options.gain, &options.max_step_m, &options.max_tissue_gain,
                       &options.min_singular_value});
      }
      controller = TipController(options);
    }
    ControlInput input = GoodInput();
    if (hostile.OneIn(4)) AddEffects(input.model);
    input.model.force_known = !hostile.OneIn(4);
    input.tip_measured = !hostile.OneIn(8);
    if (hostile.OneIn(8)) input.model.beam.status = static_cast<BeamStatus>(hostile.Below(4));
    std::vector<double*> numbers;
    for (Eigen::Vector3d* v : {&input.p_RW, &input.p_RE_desired, &input.p_RE_measured})
      AddNumbers(*v, numbers);
    AddNumbersOf(input.model, numbers);
    if (!hostile.OneIn(8)) hostile.Break(numbers);
    const ControlOutput out = controller.Step(input);
    ExpectBounded(out, input.p_RW, options.max_step_m);
    EXPECT_TRUE(out.p_RE_used.allFinite() && out.J_tip_wrist.allFinite() &&
                std::isfinite(out.smallest_singular_value));
    if (Moves(out.status)) {
      ++moved;
      EXPECT_TRUE(input.p_RE_desired.allFinite() && IsPlausible(input.model));
    }
  }
  EXPECT_GT(moved, trials / 10);  // not because it refuses everything
  RecordProperty("moved", std::to_string(moved));
}

TEST(HostileControl, NoNumberBreaksADirectionController) {
  Hostile hostile(12);
  DirectionOptions options;
  DirectionController controller(options);
  long moved = 0;
  const long trials = HostileTrials(50'000);
  for (long i = 0; i < trials && !HasFailure(); ++i) {
    if (i % 20 == 0) {
      options = {};
      if (hostile.OneIn(2)) options.priority = DirectionPriority::kPositionFirst;
      if (hostile.OneIn(10)) {
        hostile.Break({&options.gain, &options.max_step_m, &options.max_tissue_gain,
                       &options.min_singular_value, &options.position_tolerance_m,
                       &options.direction_tolerance_rad});
      }
      controller = DirectionController(options);
    }
    DirectionInput input = GoodDirection();
    if (hostile.OneIn(4)) AddEffects(input.model);
    if (hostile.OneIn(2)) input.free_axis = {0.0, 0.3, 1.0};
    std::vector<double*> numbers;
    for (Eigen::Vector3d* v : {&input.p_RW, &input.p_RE, &input.d_RE, &input.p_RE_desired,
                               &input.d_RE_desired, &input.free_axis}) {
      AddNumbers(*v, numbers);
    }
    AddNumbersOf(input.model, numbers);
    if (!hostile.OneIn(8)) hostile.Break(numbers);
    const DirectionOutput out = controller.Step(input);
    ExpectBounded(out, input.p_RW, options.max_step_m);
    EXPECT_TRUE(out.J.position.allFinite() && out.J.direction.allFinite() &&
                std::isfinite(out.position_left_m) && std::isfinite(out.direction_left_rad));
    moved += Moves(out.status);
  }
  EXPECT_GT(moved, trials / 10);
}

TEST(HostileControl, NoNumberBreaksFixtures) {
  Hostile hostile(13);
  const PathGuidance path({{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}}, 0.2, 0.001);
  const TriangleMesh corner{{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}},
                            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  const ForbiddenMesh mesh(corner);
  long good = 0;
  const long trials = HostileTrials(100'000);
  for (long i = 0; i < trials && !HasFailure(); ++i) {
    ForbiddenHalfSpace wall{{0, 0, -0.05}, Eigen::Vector3d::UnitZ()};
    ForbiddenSphere ball{{0.05, 0.0, 0.0}, 0.02, hostile.OneIn(2)};
    Fixtures fixtures;
    fixtures.margin_m = 0.001;
    fixtures.margin_sd = 3.0;
    double tip_sd_m = 1e-4;
    Eigen::Vector3d p(0.05, 0.01, 0.02);
    std::vector<double*> numbers = {&ball.radius_m, &fixtures.margin_m, &fixtures.margin_sd,
                                    &tip_sd_m};
    for (Eigen::Vector3d* v : {&p, &wall.p_plane, &wall.normal, &ball.p_centre})
      AddNumbers(*v, numbers);
    if (!hostile.OneIn(8)) hostile.Break(numbers);
    fixtures.list = {path, wall, ball, mesh};
    const FixturesOutput out = Constrain(fixtures, p, tip_sd_m);
    if (p.allFinite()) {
      ASSERT_TRUE(out.p_RE_desired.allFinite());
    }
    bool all_finite = true;
    for (const double* number : numbers) all_finite &= std::isfinite(*number);
    if (!all_finite) {
      EXPECT_EQ(out.status, FixtureStatus::kBadInput);
    }
    good += out.status != FixtureStatus::kBadInput;
  }
  EXPECT_GT(good, trials / 10);
}

}  // namespace
}  // namespace flextip
