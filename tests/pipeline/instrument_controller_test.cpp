// One cycle by itself: what it computes is that of its stages, it repeats itself bit for bit, and
// it allocates nothing.
#include "pipeline/instrument_controller.h"

#include <gtest/gtest.h>

#include <bit>
#include <memory>
#include <random>

#include "core/error.h"
#include "pipeline/tip_fusion.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/sensors.h"
#include "tests/control/allocation_counter.h"

namespace flextip {
namespace {

const Instrument kInstrument{0.6, 0.00238, 0.304, 0.0351};
const Eigen::Vector3d kPort(0.0, 0.0, 0.17), kWrist(-0.2457, 0.0, 0.3421);
const Eigen::Vector3d kGravity(0.0, 0.0, -9.81), kForce(0.2, -0.15, 0.4);
constexpr TimeNs kPeriod_ns = 33'333'333;

simulation::SensorSetup AllSensors() {
  simulation::SensorSetup s;
  s.wrist = WristStream{"", 30.0, 5e-5, 3e-4, {}};
  s.em0.emplace();
  s.em0->rate_hz = 30.0;
  s.em0->distance_from_tip_m = 0.02;
  s.em0->position_noise_m = 1.3e-4;
  s.em0->orientation_noise_rad = 5.6e-4;
  s.em1 = s.em0;
  s.strain = StrainStream{"", 30.0, {0.15, 0.5}, 8e-4, {}};
  s.load = LoadStream{"", 30.0, 5e-3, {}};
  s.tip.emplace();
  return s;
}

/// Made once: sensors on a plant whose wrist wanders, and goals.
std::vector<ControllerInputs> Session(int cycles) {
  simulation::PlantSetup setup;
  setup.instrument = kInstrument;
  setup.p_RP = kPort;
  setup.weight_N_m = kInstrument.mass_per_length_kg_m * kGravity;
  setup.load.constant_N = kForce;
  simulation::Plant plant(setup, {30, 30});
  simulation::Sensors sensors(AllSensors(), 5);
  Recording recording;
  std::vector<ControllerInputs> session;
  for (int i = 0; i < cycles; ++i) {
    ControllerInputs inputs;
    inputs.t_ns = simulation::kSimulationStart_ns + i * kPeriod_ns;
    const Eigen::Vector3d p_RW = kWrist + 0.004 * Eigen::Vector3d(std::sin(0.3 * i), 0.1 * i, 0.0);
    const simulation::PlantShape shape = plant.Solve(p_RW);
    sensors.Sample(shape, inputs.t_ns, recording);
    inputs.sensors = NewestReadings(recording);
    inputs.p_RE_desired = shape.T_RE().p + Eigen::Vector3d(0.0, 0.002, -0.001);
    session.push_back(inputs);
  }
  return session;
}

InstrumentControllerOptions Options(ControllerKind kind) {
  InstrumentControllerOptions options;
  options.estimator = EstimatorOptionsFor(kInstrument, kPort, kGravity);
  options.control.kind = kind;
  return options;
}

std::vector<ControllerCommand> Replay(const InstrumentControllerOptions& options,
                                      const std::vector<ControllerInputs>& session) {
  InstrumentController controller(options);
  std::vector<ControllerCommand> commands;
  for (const ControllerInputs& inputs : session) commands.push_back(controller.Step(inputs));
  return commands;
}

void ExpectSameBits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i]));
}

class EveryController : public testing::TestWithParam<ControllerKind> {};

TEST_P(EveryController, SaysTheSameOfTheSameInputs) {
  const auto session = Session(40);
  for (const int window : {0, 8}) {
    InstrumentControllerOptions options = Options(GetParam());
    options.window_samples = window;
    const auto once = Replay(options, session), again = Replay(options, session);
    for (std::size_t i = 0; i < session.size(); ++i) {
      EXPECT_EQ(once[i].status, again[i].status);
      ExpectSameBits(once[i].p_RW_command, again[i].p_RW_command);
      ExpectSameBits(once[i].estimate.p_RE, again[i].estimate.p_RE);
    }
  }
}

TEST_P(EveryController, AllocatesNothingOnceItRuns) {
  const auto session = Session(60);
  for (const int window : {0, 8}) {
    InstrumentControllerOptions options = Options(GetParam());
    options.window_samples = window;
    options.fixtures.list = {ForbiddenHalfSpace{{0, 0, -1.0}, Eigen::Vector3d::UnitZ()},
                             PathGuidance({{-1, 0, 0}, {1, 0, 0}}, 0.9)};
    InstrumentController controller(options);
    for (std::size_t i = 0; i < 20; ++i) controller.Step(session[i]);
    const long before = AllocationCount();
    for (std::size_t i = 20; i < session.size(); ++i) controller.Step(session[i]);
    EXPECT_EQ(AllocationCount(), before) << window;
  }
}

// The cycle adds nothing of its own to its stages.
TEST_P(EveryController, IsItsStagesOneAfterTheOther) {
  const auto session = Session(20);
  const InstrumentControllerOptions options = Options(GetParam());
  const auto commands = Replay(options, session);
  EstimatorOptions estimator_options = options.estimator;
  estimator_options.use_positions = UsesTipMeasurement(GetParam());
  ShaftEstimator estimator(estimator_options);
  TipController controller(options.control);
  for (std::size_t i = 0; i < session.size(); ++i) {
    const Measurements z = *Gather(session[i].sensors);
    const ShaftEstimate estimate = estimator.Update(z);
    ControlInput input;
    input.p_RW = z.p_RW;
    input.p_RE_desired = *session[i].p_RE_desired;
    input.tip_measured = true;
    input.p_RE_measured = GetParam() == ControllerKind::kRodTrack ? estimate.p_RE : z.tip->p_RE;
    input.model = estimate.model;
    const ControlOutput output = controller.Step(input);
    EXPECT_EQ(commands[i].status, output.status);
    ExpectSameBits(commands[i].p_RW_command, output.p_RW_command);
    ExpectSameBits(commands[i].p_RE_used, output.p_RE_used);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryController,
                         testing::Values(ControllerKind::kStraightCalculate,
                                         ControllerKind::kStraightTrack,
                                         ControllerKind::kFlexCalculate, ControllerKind::kFlexTrack,
                                         ControllerKind::kRodCalculate, ControllerKind::kRodTrack));

TEST(InstrumentController, HoldsWithoutAGoalAndGoesOnEstimating) {
  auto session = Session(5);
  InstrumentController controller(Options(ControllerKind::kRodTrack));
  session[0].p_RE_desired.reset();
  const ControllerCommand command = controller.Step(session[0]);
  EXPECT_EQ(command.status, ControlStatus::kNoGoal);
  ExpectSameBits(command.p_RW_command, session[0].sensors.wrist->value.p_RW);
  EXPECT_EQ(command.estimate.status, EstimateStatus::kOk);
}

TEST(InstrumentController, HasNoCommandWithoutTheWrist) {
  auto session = Session(1);
  session[0].sensors.wrist.reset();
  InstrumentController controller(Options(ControllerKind::kRodTrack));
  EXPECT_EQ(controller.Step(session[0]).status, ControlStatus::kNoWrist);
}

// Control may run faster than the camera: a tip that was used is not used again.
/// The same session with each tip three cycles late, at its own time.
std::vector<ControllerInputs> LateSession(int cycles) {
  const auto session = Session(cycles);
  auto late = session;
  for (std::size_t i = 0; i < late.size(); ++i) {
    late[i].sensors.tip.reset();
    if (i >= 3) late[i].sensors.tip = session[i - 3].sensors.tip;
  }
  return late;
}

TEST_P(EveryController, RepeatsItselfAndAllocatesNothingWithLateTips) {
  const auto session = LateSession(60);
  const auto first = Replay(Options(GetParam()), session);
  const auto again = Replay(Options(GetParam()), session);
  for (std::size_t i = 0; i < session.size(); ++i)
    ExpectSameBits(first[i].p_RW_command, again[i].p_RW_command);
  InstrumentController controller(Options(GetParam()));
  for (std::size_t i = 0; i < 20; ++i) controller.Step(session[i]);
  const long before = AllocationCount();
  for (std::size_t i = 20; i < session.size(); ++i) controller.Step(session[i]);
  EXPECT_EQ(AllocationCount(), before);
}

TEST(InstrumentController, ATipIsCarriedOnUntilItIsTooOld) {
  auto session = Session(2);
  InstrumentControllerOptions options = Options(ControllerKind::kStraightTrack);
  InstrumentController controller(options);
  EXPECT_NE(controller.Step(session[0]).status, ControlStatus::kNoTip);
  ControllerInputs between = session[0];
  const auto later = [&](double seconds) {
    const auto span_ns = std::llround(1e9 * seconds);
    between.t_ns = session[0].t_ns + span_ns;
    between.sensors.wrist->t_ns = session[0].sensors.wrist->t_ns + span_ns;
    return controller.Step(between).status;
  };
  EXPECT_EQ(later(0.5 * options.late.keep_s), ControlStatus::kOk);
  EXPECT_EQ(later(1.1 * options.late.keep_s), ControlStatus::kNoTip);
}

TEST(InstrumentController, AnEmSensorMayBeTheTip) {
  auto session = Session(1);
  session[0].sensors.tip.reset();
  InstrumentControllerOptions options = Options(ControllerKind::kStraightTrack);
  EXPECT_EQ(InstrumentController(options).Step(session[0]).status, ControlStatus::kNoTip);
  options.em_is_tip = true;
  const ControllerCommand command = InstrumentController(options).Step(session[0]);
  EXPECT_EQ(command.status, ControlStatus::kOk);
  const EmMeasurement& em = session[0].sensors.em0->value;
  ExpectSameBits(*command.p_RE_measured, em.T_RS.p + 0.02 * em.T_RS.R.col(0));
}

TEST(InstrumentController, FixturesKeepTheGoal) {
  auto session = Session(1);
  InstrumentControllerOptions options = Options(ControllerKind::kRodTrack);
  const double z = session[0].p_RE_desired->z() + 0.001;
  options.fixtures.list = {ForbiddenHalfSpace{{0, 0, z}, Eigen::Vector3d::UnitZ()}};
  options.fixtures.margin_sd = 3.0;
  const ControllerCommand command = InstrumentController(options).Step(session[0]);
  EXPECT_EQ(command.goal.status, FixtureStatus::kMoved);
  const double margin_m = 3.0 * MaxSd(command.estimate.p_RE_covariance_m2);
  EXPECT_NEAR(command.goal.p_RE_desired.z(), z + margin_m, 1e-9);
  EXPECT_GT(margin_m, 1e-5);
}

TEST(InstrumentController, ADirectionIsTakenWhereTheCycleHasOne) {
  auto session = Session(1);
  InstrumentControllerOptions options = Options(ControllerKind::kRodTrack);
  options.direction.emplace().direction_tolerance_rad = 0.01;
  const ControllerCommand place = InstrumentController(options).Step(session[0]);
  const Eigen::Vector3d d_RE = place.estimate.d_RE;
  session[0].d_RE_desired = d_RE + 0.2 * Eigen::Vector3d::UnitY();
  const ControllerCommand both = InstrumentController(options).Step(session[0]);
  EXPECT_EQ(both.status, ControlStatus::kOk);
  EXPECT_GT((both.p_RW_command - place.p_RW_command).norm(), 1e-3);
  options.control.kind = ControllerKind::kFlexTrack;
  EXPECT_THROW(InstrumentController{options}, InputError);
}

}  // namespace
}  // namespace flextip
