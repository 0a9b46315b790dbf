// flextip control steers flextip simulate --serve: two processes over a socket.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "tests/apps/run_program.h"
#include "tests/live/serve/press_session.h"
#include "tests/live/serve/served_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A session by OpenIGTLink.
std::string SessionOf(int port, const std::string& kind, int rate_hz, bool lockstep) {
  const auto device = [&](const char* name) {
    return fmt::format("openigtlink: {{port: {}, device: {}}}", port, name);
  };
  return PressSession(device, kind, rate_hz, lockstep);
}

class ControlledRobot : public testing::TestWithParam<const char*> {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  /// Waits until the run has written an event with these words; false after two minutes.
  bool WaitsFor(const std::string& words) const {
    const fs::path events = folder_ / "run" / "session0" / "events.csv";
    for (int i = 0; i < 1200; ++i) {
      if (fs::exists(events) && ReadText(events).find(words) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }
  TestFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(EveryController, ControlledRobot, EveryKind(), NameOfKind);

TEST_P(ControlledRobot, FollowsItsPathInLockstepAndReplaysBitForBit) {
  ServedProgram robot({kPressScenario, "--serve", "0", "--lockstep", "-o", Path("served")});
  ASSERT_GT(robot.port(), 0);
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), GetParam(), 30, true));
  ExpectPathDone(robot, session, folder_);
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "again"));
}

TEST_F(ControlledRobot, LeavesARecordingThatOtherCommandsOpen) {
  ServedProgram robot({kPressScenario, "--serve", "0", "--lockstep"});
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), "rod-track", 30, true));
  ASSERT_EQ(RunProgram({"control", session, "-o", Path("run"), "--duration", "60"}).exit_code, 0);
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "run"));
  const ProgramResult check = RunProgram({"check", Path("run"), "-o", Path("check")});
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
  const ProgramResult estimate = RunProgram({"estimate", Path("run"), "-o", Path("states")});
  EXPECT_EQ(estimate.exit_code, 0) << estimate.err;
  std::string other = ReadText(session);
  other.replace(other.find("speed_m_s: 0.01"), 15, "speed_m_s: 0.02");
  const ProgramResult slower =
      RunProgram({"replay", Path("run"), "--session", folder_.Write("other.yaml", other), "-o",
                  Path("other")});
  EXPECT_EQ(slower.exit_code, 0) << slower.err;
  EXPECT_THAT(slower.out, testing::Not(HasSubstr("55 of 55")));
}

/// The laparoscope's pictures in place of a tip that is measured.
TEST_F(ControlledRobot, IsSteeredByWhatItsCameraSees) {
  ServedProgram robot({kPressScenario, "--serve", "0", "--lockstep", "--render"});
  std::string text = SessionOf(robot.port(), "rod-track", 30, true);
  const std::string data = std::string(FLEXTIP_SOURCE_DIR) + "/testdata";
  const std::size_t from = text.find("  vision0:"), to = text.find("\nrobot:");
  text.replace(from, to - from,
               fmt::format("  cam0: {{openigtlink: {{port: {}, device: cam0}}, sensor: {}, "
                           "collar: {}}}",
                           robot.port(), data + "/cameras/laparoscope.yaml",
                           data + "/collars/hexagon/sensor.yaml"));
  const std::string session = folder_.Write("session.yaml", text);
  const ProgramResult run = RunProgram({"control", session, "-o", Path("run"), "--duration", "90"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("the path is done"));
  const ProgramResult again = RunProgram({"replay", Path("run"), "-o", Path("again")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST_F(ControlledRobot, IsPausedByCtrlCInRealTime) {
  ServedProgram robot({kPressScenario, "--serve", "0"});
  std::string text = SessionOf(robot.port(), "rod-track", 120, false);
  text.replace(text.find("speed_m_s: 0.01"), 15, "speed_m_s: 1e-4");
  const std::string session = folder_.Write("session.yaml", text);
  const pid_t control = fork();
  if (control == 0) {
    const std::string out = Path("run");
    execl(FLEXTIP_PROGRAM, FLEXTIP_PROGRAM, "-q", "control", session.c_str(), "-o", out.c_str(),
          nullptr);
    _exit(127);
  }
  EXPECT_TRUE(WaitsFor("hold: none"));  // it moves
  kill(control, SIGINT);
  int status = 0;
  waitpid(control, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  robot.Interrupt();
  EXPECT_EQ(robot.Wait(), 0);
  EXPECT_THAT(robot.out(), HasSubstr("PAUSED homed"));
  EXPECT_EQ(RunProgram({"replay", Path("run"), "-o", Path("again")}).exit_code, 0);
}

TEST_F(ControlledRobot, IsNotEnabledByATiming) {
  ServedProgram robot({kPressScenario, "--serve", "0"});
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), "rod-track", 120, false));
  const ProgramResult run = RunProgram({"control", session, "--timing", "3"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("wrist's sample to command sent"));
  robot.Interrupt();
  robot.Wait();
  EXPECT_THAT(robot.out(), testing::Not(HasSubstr("ENABLED")));
}

TEST_F(ControlledRobot, IsNotTouchedWhereASessionIsWrong) {
  std::string text = SessionOf(18944, "rod-track", 120, false);
  text.replace(text.find("length_m: 0.6"), 13, "length_m: 600");
  const std::string session = folder_.Write("session.yaml", text);
  EXPECT_TRUE(IsRefused(RunProgram({"control", session, "-o", Path("run")}),
                        {"session.yaml:3", "length_m", "600"}));
}

}  // namespace
}  // namespace flextip
