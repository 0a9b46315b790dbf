// flextip control with the poses of flextip simulate --serve --udp: two processes, JSON datagrams
// one way and OpenIGTLink for all that dVRK's streamer does not send.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

#include "tests/apps/run_program.h"
#include "tests/live/serve/press_session.h"
#include "tests/live/serve/served_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;

/// A port for datagrams that nobody has at the moment.
int FreeUdpPort() {
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ::bind(fd, reinterpret_cast<sockaddr*>(&address), size);
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(fd);
  return ntohs(address.sin_port);
}

std::string SessionOf(int port, int udp_port, const std::string& kind, bool lockstep) {
  const auto device = [&](const char* name) {
    if (std::strcmp(name, "PSM1/measured_cp") == 0)
      return fmt::format("udp: {{port: {}, device: measured_cp}}", udp_port);
    if (std::strcmp(name, "em0") == 0)
      return fmt::format("udp: {{port: {}, device: em0}}", udp_port);
    return fmt::format("openigtlink: {{port: {}, device: {}}}", port, name);
  };
  return PressSession(device, kind, lockstep ? 30 : 120, lockstep);
}

class UdpRobot : public testing::TestWithParam<const char*> {
 protected:
  TestFolder folder_;
  const int udp_port_ = FreeUdpPort();
};

INSTANTIATE_TEST_SUITE_P(EveryController, UdpRobot, EveryKind(), NameOfKind);

TEST_P(UdpRobot, FollowsItsPathInLockstepAndReplaysBitForBit) {
  ServedProgram robot(
      {kPressScenario, "--serve", "0", "--lockstep", "--udp", std::to_string(udp_port_)});
  ASSERT_GT(robot.port(), 0);
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), udp_port_, GetParam(), true));
  ExpectPathDone(robot, session, folder_);
}

TEST_F(UdpRobot, WhosePosesAreAbsentIsSaidAndNothingMoves) {
  ServedProgram robot({kPressScenario, "--serve", "0"});
  const std::string session =
      folder_.Write("session.yaml", SessionOf(robot.port(), udp_port_, "rod-track", false));
  const ProgramResult run =
      RunProgram({"control", session, "-o", (folder_ / "run").string(), "--duration", "2"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("held, source_lost"));
  EXPECT_THAT(ReadText(folder_ / "run/session0/events.csv"),
              HasSubstr(fmt::format("udp 127.0.0.1:{}: no pose for a second", udp_port_)));
  robot.Interrupt();
  EXPECT_EQ(robot.Wait(), 0);
  EXPECT_THAT(robot.out(), HasSubstr("set-points followed                     0"));
}

}  // namespace
}  // namespace flextip
