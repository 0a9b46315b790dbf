// flextip control steers flextip simulate --serve --ros2: two processes over DDS.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <optional>
#include <thread>

#include "tests/apps/run_program.h"
#include "tests/live/dds/domain_of_tests.h"
#include "tests/live/serve/press_session.h"
#include "tests/live/serve/served_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;

const std::string kDomain = std::to_string(live::DomainOfTests());

std::string SessionOf(const std::string& kind, int rate_hz, bool lockstep) {
  const auto device = [](const char* name) {
    return fmt::format("ros2: {{topic: /{}, domain: {}}}", name, kDomain);
  };
  return PressSession(device, kind, rate_hz, lockstep);
}

class Ros2Robot : public testing::TestWithParam<const char*> {
 protected:
  static std::vector<std::string> Served(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{kPressScenario, "--serve",       "0",
                                       "--ros2",       "--ros2-domain", kDomain};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  TestFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(EveryController, Ros2Robot, EveryKind(), NameOfKind);

TEST_P(Ros2Robot, FollowsItsPathInLockstepAndReplaysBitForBit) {
  ServedProgram robot(Served({"--lockstep"}));
  ASSERT_GT(robot.port(), 0);
  ExpectPathDone(robot, folder_.Write("session.yaml", SessionOf(GetParam(), 30, true)), folder_);
}

/// The first samples are not lost, and state commands come before the set-point that lets time go
/// on: all that was received and commanded is the same again.
TEST_F(Ros2Robot, InLockstepSixRunsAreTheSameBitForBit) {
  const std::string session = folder_.Write("session.yaml", SessionOf("rod-track", 30, true));
  std::string first;
  constexpr int kRuns = 6;
  for (int i = 0; i < kRuns; ++i) {
    const std::string name = fmt::format("run{}", i);
    ServedProgram robot(Served({"--lockstep"}));
    ASSERT_GT(robot.port(), 0);
    const ProgramResult run =
        RunProgram({"control", session, "-o", Path(name), "--duration", "120"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const std::string cycles = CyclesOf(folder_ / name);
    EXPECT_GT(std::count(cycles.begin(), cycles.end(), '\n'), 30);
    if (first.empty()) first = cycles;
    EXPECT_TRUE(cycles == first) << name;
  }
}

TEST_F(Ros2Robot, ThatIsAbsentIsALineATopicAndNothingMoves) {
  const std::string session = folder_.Write("session.yaml", SessionOf("rod-track", 120, false));
  const ProgramResult run = RunProgram({"control", session, "-o", Path("run"), "--duration", "2"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("held, source_lost"));
  const std::string events = ReadText(folder_ / "run/session0/events.csv");
  for (const char* const topic : {"PSM1/measured_cp", "em0", "strain0", "vision0"}) {
    EXPECT_THAT(events, HasSubstr(fmt::format("ros2 domain {}: nobody sends {}", kDomain, topic)));
  }
  EXPECT_THAT(events, HasSubstr("nobody reads PSM1/servo_cp"));
}

TEST_F(Ros2Robot, ThatGoesAndReturnsIsSaidAndHeardAgain) {
  std::string text = SessionOf("rod-track", 120, false);
  text.replace(text.find("speed_m_s: 0.01"), 15, "speed_m_s: 1e-4");
  const std::string session = folder_.Write("session.yaml", text);
  auto robot = std::make_optional<ServedProgram>(Served({}));
  ASSERT_GT(robot->port(), 0);
  ProgramResult run;
  std::thread control([&] {
    run = RunProgram({"control", session, "-o", Path("run"), "--duration", "8"});
  });
  std::this_thread::sleep_for(std::chrono::seconds(3));
  robot->Interrupt();
  robot->Wait();
  robot.emplace(Served({}));
  control.join();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const std::string events = ReadText(folder_ / "run/session0/events.csv");
  const std::size_t gone = events.find("PSM1/measured_cp is not sent any more");
  ASSERT_NE(gone, std::string::npos) << events;
  EXPECT_NE(events.find("PSM1/measured_cp is sent", gone + 1), std::string::npos) << events;
  robot->Interrupt();
  EXPECT_EQ(robot->Wait(), 0);
  EXPECT_EQ(RunProgram({"replay", Path("run"), "-o", Path("again")}).exit_code, 0);
}

TEST_F(Ros2Robot, IsRefusedWithADomainThatIsNone) {
  EXPECT_TRUE(IsRefused(
      RunProgram({"simulate", kPressScenario, "--serve", "0", "--ros2", "--ros2-domain", "300"}),
      {"--ros2-domain", "300", "0 to 232"}));
}

}  // namespace
}  // namespace flextip
