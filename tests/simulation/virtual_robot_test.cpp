// The robot that is not there: its states, its clocks and its motion.
#include "simulation/virtual_robot/virtual_robot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "core/error.h"

namespace flextip::simulation {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr TimeNs kStart_ns = kSimulationStart_ns;
constexpr TimeNs kSecond_ns = 1'000'000'000;

VirtualRobotSetup SmallRobot() {
  VirtualRobotSetup setup;
  setup.plant.instrument = {0.6, 0.00238, 0.304, 0.0};
  setup.plant.p_RP = {0.0, 0.0, 0.17};
  setup.base.instrument = setup.plant.instrument;
  setup.base.p_RP = setup.plant.p_RP;
  setup.plant_options = {30, 30};
  setup.p_RW_start = {-0.2457, 0.0, 0.3421};
  setup.servo.max_speed_m_s = 0.05;
  setup.sensors.wrist.emplace();
  setup.sensors.wrist->rate_hz = 100.0;
  setup.sensors.wrist->position_noise_m = 0.0;
  return setup;
}

void MakeReady(VirtualRobot& robot) {
  ASSERT_TRUE(robot.Command(CrtkCommand::kEnable));
  ASSERT_TRUE(robot.Command(CrtkCommand::kHome));
  robot.Advance(robot.Now() + kSecond_ns);
  ASSERT_EQ(Text(robot.State()), "ENABLED homed");
}

/// The states of a step, in their order.
std::vector<std::string> States(const std::vector<VirtualSample>& samples) {
  std::vector<std::string> states;
  for (const VirtualSample& sample : samples)
    if (const auto* state = std::get_if<CrtkOperatingState>(&sample.value))
      states.push_back(Text(*state));
  return states;
}

TEST(CrtkMachine, EveryCommandInEveryStateLeadsWhereTheTableSays) {
  using enum CrtkCommand;
  const std::string no = "refused";
  const std::map<std::string, std::map<std::string, std::string>> table = {
      {"DISABLED",
       {{"enable", "ENABLED"},
        {"disable", "DISABLED"},
        {"pause", no},
        {"resume", no},
        {"home", "DISABLED"},
        {"unhome", "DISABLED"}}},
      {"ENABLED",
       {{"enable", "ENABLED"},
        {"disable", "DISABLED"},
        {"pause", "PAUSED"},
        {"resume", "ENABLED"},
        {"home", "ENABLED"},
        {"unhome", "ENABLED"}}},
      {"PAUSED",
       {{"enable", no},
        {"disable", "DISABLED"},
        {"pause", "PAUSED"},
        {"resume", "ENABLED"},
        {"home", no},
        {"unhome", no}}},
      {"FAULT",
       {{"enable", no},
        {"disable", "DISABLED"},
        {"pause", no},
        {"resume", no},
        {"home", no},
        {"unhome", no}}}};
  int checked = 0;
  for (const auto& [state, row] : table) {
    for (const auto& [command, after] : row) {
      const auto found = StateAfter(*CrtkStateOf(state), *CrtkCommandOf(command));
      EXPECT_EQ(found ? Name(*found) : no, after) << command << " in " << state;
      ++checked;
    }
  }
  EXPECT_EQ(checked, 24);
}

TEST(CrtkMachine, NobodyCommandsAFault) {
  for (const char* const state : {"DISABLED", "ENABLED", "PAUSED"}) {
    for (const char* const command : {"enable", "disable", "pause", "resume", "home", "unhome"}) {
      const auto after = StateAfter(*CrtkStateOf(state), *CrtkCommandOf(command));
      EXPECT_TRUE(!after || *after != CrtkState::kFault);
    }
  }
}

TEST(CrtkMachine, HomingTakesAMomentAndCanBeCutShort) {
  CrtkMachine machine(100);
  EXPECT_TRUE(machine.Take(CrtkCommand::kHome, 1000));
  EXPECT_EQ(Text(machine.State()), "DISABLED busy");
  EXPECT_FALSE(machine.Advance(1099));
  EXPECT_TRUE(machine.Advance(1100));
  EXPECT_EQ(Text(machine.State()), "DISABLED homed");
  EXPECT_FALSE(machine.Follows());
  EXPECT_TRUE(machine.Take(CrtkCommand::kEnable, 1200));
  EXPECT_TRUE(machine.Follows());
  EXPECT_TRUE(machine.Take(CrtkCommand::kHome, 1300));
  EXPECT_EQ(Text(machine.State()), "ENABLED busy");
  EXPECT_FALSE(machine.Follows());
  EXPECT_TRUE(machine.Take(CrtkCommand::kDisable, 1350));
  EXPECT_EQ(Text(machine.State()), "DISABLED");
  EXPECT_FALSE(machine.Advance(1400));
  EXPECT_TRUE(machine.Take(CrtkCommand::kHome, 1500));
  EXPECT_TRUE(machine.Take(CrtkCommand::kUnhome, 1550));
  EXPECT_FALSE(machine.Advance(1700));
  EXPECT_EQ(Text(machine.State()), "DISABLED");
}

TEST(CrtkMachine, DisableKeepsTheHomingThatIsDone) {
  CrtkMachine machine(100);
  machine.Take(CrtkCommand::kHome, 0);
  machine.Advance(100);
  machine.Take(CrtkCommand::kEnable, 100);
  machine.Take(CrtkCommand::kDisable, 100);
  EXPECT_EQ(Text(machine.State()), "DISABLED homed");
  machine.Fail();
  EXPECT_EQ(Text(machine.State()), "FAULT homed");
  EXPECT_TRUE(machine.Take(CrtkCommand::kDisable, 200));
  EXPECT_EQ(Text(machine.State()), "DISABLED homed");
}

TEST(VirtualRobot, EverySensorKeepsItsClock) {
  VirtualRobotSetup setup = SmallRobot();
  setup.sensors.em0.emplace().rate_hz = 40.0;
  setup.sensors.em0->distance_from_tip_m = 0.02;
  setup.sensors.load.emplace().rate_hz = 30.0;
  setup.picture_rate_hz = 25.0;
  VirtualRobot robot(setup);
  std::map<std::size_t, int> count;
  TimeNs last_ns = 0;
  for (int step = 1; step <= 200; ++step) {
    for (const VirtualSample& sample : robot.Advance(kStart_ns + step * (kSecond_ns / 200) - 1)) {
      ++count[sample.value.index()];
      EXPECT_GE(sample.t_ns, last_ns);
      last_ns = sample.t_ns;
    }
  }
  EXPECT_EQ(count[0], 100);  // wrist
  EXPECT_EQ(count[1], 40);   // EM
  EXPECT_EQ(count[3], 30);   // load
  EXPECT_EQ(count[5], 25);   // pictures
  EXPECT_EQ(count[6], 1);    // state, once a second
}

TEST(VirtualRobot, ItsPicturesAreAsLateAsTheCamera) {
  VirtualRobotSetup setup = SmallRobot();
  setup.picture_rate_hz = 25.0;
  setup.sensor_effects.camera_latency_s = 0.06;  // six samples of the wrist
  VirtualRobot robot(setup);
  MakeReady(robot);
  ASSERT_TRUE(robot.MoveTo(setup.p_RW_start + Eigen::Vector3d(0.0, 0.03, 0.0)));
  std::map<TimeNs, Eigen::Vector3d> shown;
  for (const VirtualSample& sample : robot.Advance(robot.Now() + kSecond_ns / 2))
    if (const auto* due = std::get_if<PictureDue>(&sample.value))
      shown[sample.t_ns] = due->curve.T_RE.p;
  double moved_m = 0.0;
  int compared = 0;
  for (const auto& [t_ns, p_RE] : shown) {
    for (const auto& truth : robot.Truth()) {
      const double apart_m = (p_RE - truth.value.p_RE).norm();
      if (truth.t_ns == t_ns - 60'000'000) {
        EXPECT_LT(apart_m, 1e-9) << t_ns;
        ++compared;
      }
      if (truth.t_ns == t_ns) moved_m = std::max(moved_m, apart_m);
    }
  }
  EXPECT_GT(compared, 10);
  EXPECT_GT(moved_m, 0.001);
}

TEST(VirtualRobot, DoesNotMoveBeforeItIsEnabledAndHomed) {
  VirtualRobot robot(SmallRobot());
  const Eigen::Vector3d p = SmallRobot().p_RW_start + Eigen::Vector3d(0.0, 0.0, 0.001);
  robot.Advance(kStart_ns);
  EXPECT_FALSE(robot.MoveTo(p));
  robot.Command(CrtkCommand::kEnable);
  EXPECT_FALSE(robot.MoveTo(p));
  robot.Command(CrtkCommand::kHome);
  EXPECT_FALSE(robot.MoveTo(p));
  robot.Advance(kStart_ns + kSecond_ns);
  EXPECT_FALSE(robot.MoveTo(Eigen::Vector3d(0, NAN, 0)));
  EXPECT_TRUE(robot.MoveTo(p));
  robot.Command(CrtkCommand::kPause);
  EXPECT_FALSE(robot.MoveTo(p));
  robot.Advance(kStart_ns + 2 * kSecond_ns);
  for (const auto& sample : robot.Kept().wrist0->samples)
    EXPECT_LT((sample.value.p_RW - SmallRobot().p_RW_start).norm(), 1e-12);
}

TEST(VirtualRobot, FollowsSetPointsAtItsLargestSpeed) {
  VirtualRobot robot(SmallRobot());
  MakeReady(robot);
  const Eigen::Vector3d from = SmallRobot().p_RW_start, to = from + Eigen::Vector3d(0.0, 0.01, 0.0);
  ASSERT_TRUE(robot.MoveTo(to));
  robot.Advance(robot.Now() + kSecond_ns);
  const auto& wrist = robot.Kept().wrist0->samples;
  for (std::size_t i = 1; i < wrist.size(); ++i) {
    const double step_m = (wrist[i].value.p_RW - wrist[i - 1].value.p_RW).norm();
    EXPECT_LE(step_m, 0.05 * 0.01 + 1e-9);
  }
  EXPECT_LT((wrist.back().value.p_RW - to).norm(), 1e-9);
  // 10 mm at 50 mm/s: 0.2 s after the set-point and no sooner.
  const auto at = [&](double t_s) { return robot.Truth()[0].t_ns + std::llround(1e9 * t_s); };
  for (const auto& truth : robot.Truth()) {
    const double left_m = (truth.value.p_RW - to).norm();
    EXPECT_TRUE(truth.t_ns >= at(1.19) || left_m > 0.0004) << left_m;
    EXPECT_TRUE(truth.t_ns <= at(1.21) || left_m < 1e-9) << left_m;
  }
}

TEST(VirtualRobot, PauseStopsItWhereItIs) {
  VirtualRobot robot(SmallRobot());
  MakeReady(robot);
  robot.MoveTo(SmallRobot().p_RW_start + Eigen::Vector3d(0.0, 0.01, 0.0));
  robot.Advance(robot.Now() + kSecond_ns / 10);
  const Eigen::Vector3d stopped = robot.Kept().wrist0->samples.back().value.p_RW;
  EXPECT_NEAR((stopped - SmallRobot().p_RW_start).norm(), 0.005, 0.0006);
  robot.Command(CrtkCommand::kPause);
  robot.Advance(robot.Now() + kSecond_ns);
  robot.Command(CrtkCommand::kResume);
  robot.Advance(robot.Now() + kSecond_ns);
  EXPECT_LT((robot.Kept().wrist0->samples.back().value.p_RW - stopped).norm(), 0.0006);
}

TEST(VirtualRobot, SaysItsStateAtEachChangeAndOnceASecond) {
  VirtualRobot robot(SmallRobot());
  EXPECT_THAT(States(robot.Advance(kStart_ns)), ElementsAre("DISABLED"));
  EXPECT_THAT(States(robot.Advance(kStart_ns + kSecond_ns / 10)), ElementsAre());
  robot.Command(CrtkCommand::kEnable);
  robot.Command(CrtkCommand::kEnable);  // no change
  robot.Command(CrtkCommand::kHome);
  EXPECT_THAT(States(robot.Advance(robot.Now())), ElementsAre("ENABLED", "ENABLED busy"));
  EXPECT_THAT(States(robot.Advance(kStart_ns + 9 * (kSecond_ns / 10))),
              ElementsAre("ENABLED homed"));
  EXPECT_THAT(States(robot.Advance(kStart_ns + 2 * kSecond_ns)),
              ElementsAre("ENABLED homed", "ENABLED homed"));
}

TEST(VirtualRobot, GoesToFaultWhereTheShaftHasNoEquilibriumAndComesBack) {
  VirtualRobotSetup setup = SmallRobot();
  setup.servo.max_speed_m_s = 1.0;
  VirtualRobot robot(setup);
  MakeReady(robot);
  robot.MoveTo({-1.2, 0.0, 0.8});  // beyond the shaft's length from the port
  const auto samples = robot.Advance(robot.Now() + 3 * kSecond_ns);
  EXPECT_EQ(robot.State().state, CrtkState::kFault);
  EXPECT_THAT(robot.FaultReason(), HasSubstr("lost its equilibrium"));
  EXPECT_TRUE(robot.Shape().IsUsable());
  EXPECT_FALSE(robot.MoveTo(setup.p_RW_start));
  EXPECT_FALSE(robot.Command(CrtkCommand::kEnable));
  EXPECT_TRUE(robot.Command(CrtkCommand::kDisable));
  EXPECT_TRUE(robot.Command(CrtkCommand::kEnable));
  EXPECT_TRUE(robot.MoveTo(setup.p_RW_start));
  robot.Advance(robot.Now() + 3 * kSecond_ns);
  EXPECT_EQ(robot.State().state, CrtkState::kEnabled);
  EXPECT_LT((robot.Kept().wrist0->samples.back().value.p_RW - setup.p_RW_start).norm(), 1e-9);
}

TEST(VirtualRobot, TheStepsOfTimeDoNotChangeTheSamples) {
  const auto run = [](TimeNs step_ns) {
    VirtualRobotSetup setup = SmallRobot();
    setup.sensors.wrist->position_noise_m = 5e-5;
    VirtualRobot robot(setup);
    robot.Command(CrtkCommand::kEnable);
    robot.Command(CrtkCommand::kHome);
    for (TimeNs t_ns = kStart_ns; t_ns <= kStart_ns + 2 * kSecond_ns; t_ns += step_ns)
      robot.Advance(t_ns);
    return robot.Kept().wrist0->samples;
  };
  const auto coarse = run(kSecond_ns), fine = run(kSecond_ns / 1000);
  ASSERT_EQ(coarse.size(), fine.size());
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    EXPECT_EQ(coarse[i].t_ns, fine[i].t_ns);
    EXPECT_EQ(coarse[i].value.p_RW, fine[i].value.p_RW);
  }
}

TEST(VirtualRobot, KeepsNothingWhereItShallNot) {
  VirtualRobotSetup setup = SmallRobot();
  setup.keep = false;
  VirtualRobot robot(setup);
  MakeReady(robot);
  robot.MoveTo(setup.p_RW_start);
  EXPECT_FALSE(robot.Advance(robot.Now() + kSecond_ns).empty());
  EXPECT_TRUE(robot.Kept().wrist0->samples.empty());
  EXPECT_TRUE(robot.Truth().empty());
  EXPECT_FALSE(robot.Kept().command0);
}

TEST(VirtualRobot, RefusesAStartWithoutEquilibrium) {
  VirtualRobotSetup setup = SmallRobot();
  setup.p_RW_start = {-3.0, 0.0, 0.3};
  EXPECT_THROW(VirtualRobot{setup}, InputError);
}

Eigen::Vector3d After(const WristServoSetup& setup, TimeNs t_ns, TimeNs step_ns) {
  WristServo servo(setup, Eigen::Vector3d::Zero(), 5);
  servo.MoveTo({0.01, 0.0, 0.0});
  for (TimeNs t = step_ns; t <= t_ns; t += step_ns) servo.Advance(kStart_ns + t);
  return servo.p_RW();
}

TEST(WristServo, ApproachesByItsLagWhateverTheSteps) {
  const WristServoSetup setup{10.0, 0.05, 0.0, 0.0};
  const TimeNs t_ns = 80'000'000;
  const double expected = 0.01 * (1.0 - std::exp(-0.08 / 0.05));
  EXPECT_NEAR(After(setup, t_ns, t_ns).x(), expected, 1e-15);
  EXPECT_NEAR(After(setup, t_ns, 1'000'000).x(), expected, 1e-15);
}

TEST(WristServo, KeepsItsLargestSpeed) {
  EXPECT_NEAR(After({0.02, 0.001, 0.0, 0.0}, 100'000'000, 1'000'000).x(), 0.002, 1e-12);
  EXPECT_NEAR(After({0.02, 0.0, 0.0, 0.0}, 100'000'000, 7'000'000).x(), 0.02 * 0.098, 1e-12);
}

TEST(WristServo, TakesSetPointsUpAtItsOwnTicks) {
  WristServo servo({10.0, 0.0, 100.0, 0.0}, Eigen::Vector3d::Zero(), 5);
  servo.Advance(kStart_ns + 1'000'000);
  servo.MoveTo({0.01, 0.0, 0.0});
  servo.Advance(kStart_ns + 9'999'999);
  EXPECT_EQ(servo.p_RW().x(), 0.0);
  servo.Advance(kStart_ns + 12'000'000);
  EXPECT_NEAR(servo.p_RW().x(), 0.01, 1e-12);
  servo.MoveTo({0.02, 0.0, 0.0});
  servo.Stay();  // what was sent and not taken up is forgotten, too
  servo.Advance(kStart_ns + 50'000'000);
  EXPECT_NEAR(servo.p_RW().x(), 0.01, 1e-12);
}

TEST(WristServo, LosesThePartOfItsSetPointsThatItIsTold) {
  WristServo servo({1e6, 0.0, 0.0, 0.3}, Eigen::Vector3d::Zero(), 5);
  int lost = 0;
  for (int i = 1; i <= 4000; ++i) {
    servo.MoveTo({static_cast<double>(i), 0.0, 0.0});
    servo.Advance(kStart_ns + TimeNs{i} * 1'000'000);
    lost += servo.p_RW().x() != i;
  }
  EXPECT_NEAR(lost, 1200, 4 * std::sqrt(4000 * 0.3 * 0.7));
}

}  // namespace
}  // namespace flextip::simulation
