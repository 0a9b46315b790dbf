// flextip control steers flextip simulate --serve: two processes over a socket.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "tests/apps/run_program.h"
#include "tests/live/serve/served_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kScenario = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml";

/// A session on the robot of press.yaml: 2 mm down into the tissue and back.
std::string SessionOf(int port, const std::string& kind, int rate_hz, bool lockstep) {
  const auto device = [&](const char* name) {
    return fmt::format("openigtlink: {{port: {}, device: {}}}", port, name);
  };
  return fmt::format(
      R"(format: flextip-session
version: 1
instrument: {{length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}}
port: {{position_m: [0.0, 0.0, 0.17]}}
gravity_m_s2: [0.0, 0.0, -9.81]
sources:
  wrist0: {{{0}, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}}
  em0: {{{1}, distance_from_tip_m: 0.02, position_noise_m: 0.00013, orientation_noise_rad: 0.00056}}
  strain0: {{{2}, stations_from_wrist_m: [0.15, 0.5], moment_noise_Nm: 0.0008}}
  vision0: {{{3}}}
robot:
  command: {{{4}}}
  state: {{{5}}}
  command_state: {{{6}}}
{7}controller: {{kind: {8}, rate_hz: {9}}}
limits: {{max_step_m: 0.02, max_speed_m_s: 0.1, max_acceleration_m_s2: 10}}
path: {{frame: start, average_s: 0.3, speed_m_s: 0.01, settle_s: 0.2,
       waypoints: [{{to_m: [0, 0, -0.002]}}, {{to_m: [0, 0, 0]}}]}}
)",
      device("PSM1/measured_cp"), device("em0"), device("strain0"), device("vision0"),
      device("PSM1/servo_cp"), device("PSM1/operating_state"), device("PSM1/state_command"),
      lockstep ? fmt::format("  lockstep: {{{}}}\n", device("lockstep")) : "", kind, rate_hz);
}

class ControlledRobot : public testing::TestWithParam<const char*> {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  TestFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(EveryController, ControlledRobot,
                         testing::Values("straight-calculate", "straight-track", "flex-calculate",
                                         "flex-track", "rod-calculate", "rod-track"),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(ControlledRobot, FollowsItsPathInLockstepAndReplaysBitForBit) {
  ServedProgram robot({kScenario, "--serve", "0", "--lockstep", "-o", Path("served")});
  ASSERT_GT(robot.port(), 0);
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), GetParam(), 30, true));
  const ProgramResult run = RunProgram({"control", session, "-o", Path("run"), "--duration", "60"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("the path is done"));
  EXPECT_THAT(run.out, HasSubstr("the robot is not enabled"));
  EXPECT_EQ(robot.Wait(), 0);
  EXPECT_THAT(robot.out(), HasSubstr("PAUSED homed"));
  const ProgramResult again = RunProgram({"replay", Path("run"), "-o", Path("again")});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "again"));
}

TEST_F(ControlledRobot, LeavesARecordingThatOtherCommandsOpen) {
  ServedProgram robot({kScenario, "--serve", "0", "--lockstep"});
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), "rod-track", 30, true));
  ASSERT_EQ(RunProgram({"control", session, "-o", Path("run"), "--duration", "60"}).exit_code, 0);
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
  ServedProgram robot({kScenario, "--serve", "0", "--lockstep", "--render"});
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
  ServedProgram robot({kScenario, "--serve", "0"});
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
  std::this_thread::sleep_for(std::chrono::seconds(4));
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
  ServedProgram robot({kScenario, "--serve", "0"});
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), "rod-track", 120, false));
  const ProgramResult run = RunProgram({"control", session, "--timing", "1"});
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
