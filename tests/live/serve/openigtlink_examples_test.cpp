// The example programs of OpenIGTLink's own authors (Debian: openigtlink-examples) at the virtual
// robot and at what viewers see. Two of them send one name and fixed words: these are changed in
// their text (tests/live/openigtlink_examples.cmake), nothing else.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include "tests/live/serve/press_session.h"

namespace flextip {
namespace {

/// A program that runs until it is told to end; what it says goes to a file.
class Program {
 public:
  Program(const std::string& file, std::vector<std::string> words) : file_(file) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int out = ::open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(out, STDOUT_FILENO);
      ::dup2(out, STDERR_FILENO);
      ::execv(argv[0], argv.data());
      _exit(127);
    }
    ::close(out);
  }
  ~Program() { End(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void End() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  std::string Said() const { return ReadText(file_); }

  /// Waits until it has said what `fits`; a minute at most.
  bool Says(const std::function<bool(const std::string&)>& fits) const {
    for (int i = 0; i < 600; ++i) {
      if (fits(Said())) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

 private:
  std::string file_;
  pid_t pid_ = -1;
};

/// The places (mm) of the transforms that ReceiveClient has printed.
std::vector<Eigen::Vector3d> PlacesIn(const std::string& said) {
  std::vector<Eigen::Vector3d> places;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (line != "=============") continue;
    Eigen::Vector3d p;
    for (double& x : p) {
      if (!std::getline(lines, line)) return places;
      const std::size_t last = line.rfind(", ");
      if (last == std::string::npos) return places;
      x = std::stod(line.substr(last + 2));
    }
    if (!std::getline(lines, line) || !std::getline(lines, line)) return places;
    places.push_back(p);
  }
  return places;
}

sockaddr_in Local(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// Returns a port of this machine that nobody listens to.
int FreePort() {
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address = Local(0);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(listener);
  return ntohs(address.sin_port);
}

/// Waits until somebody listens there; a minute at most.
bool IsListenedTo(int port) {
  const sockaddr_in address = Local(port);
  for (int i = 0; i < 600; ++i) {
    const int peer = ::socket(AF_INET, SOCK_STREAM, 0);
    const int failed = ::connect(peer, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    ::close(peer);
    if (failed == 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return false;
}

std::function<bool(const std::string&)> Holds(const std::string& part) {
  return [part](const std::string& said) { return said.find(part) != std::string::npos; };
}

class OpenIgtLinkExamples : public testing::Test {
 protected:
  void SetUp() override {
    if (std::string(RECEIVE_CLIENT).empty())
      GTEST_SKIP() << "apt-get install openigtlink-examples, and configure again";
  }
  std::string Path(const char* name) const { return (folder_ / name).string(); }
  /// Starts an example at the server of this machine at `port`.
  Program Start(const char* program, int port, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {program, "127.0.0.1", std::to_string(port)});
    return Program(Path((std::to_string(++started_) + ".txt").c_str()), more);
  }

  TestFolder folder_;
  int started_ = 0;
};

TEST_F(OpenIgtLinkExamples, ReadAndDriveTheVirtualRobot) {
  // TrackerClient goes round at 50 mm (cos, sin, cos), a fifth of a radian a message.
  const std::string scenario = folder_.Write("scenario.yaml", R"(
instrument: {length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}
port: {position_m: [0.0, 0.0, -0.2]}
wrist: {start_m: [0.05, 0.0, 0.05], max_speed_m_s: 1.0}
sensors:
  wrist: {rate_hz: 120, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}
path: {waypoints: [{to_m: [0.0, 0.0, -0.001]}]}
controllers: [straight-calculate]
)");
  ServedProgram robot({scenario, "--serve", "0", "--duration", "120"});
  ASSERT_GT(robot.port(), 0);
  const Program reader = Start(RECEIVE_CLIENT, robot.port());
  ASSERT_TRUE(reader.Says([](const std::string& said) { return PlacesIn(said).size() > 100; }));
  for (const Eigen::Vector3d& p : PlacesIn(reader.Said()))
    EXPECT_LT((p - Eigen::Vector3d(50.0, 0.0, 50.0)).norm(), 0.4);  // eight deviations
  ASSERT_TRUE(reader.Says(Holds("String: DISABLED")));

  Program operator_says = Start(STRING_CLIENT, robot.port(), {"5"});
  ASSERT_TRUE(reader.Says(Holds("String: ENABLED homed\n")));
  operator_says.End();
  const std::size_t seen = PlacesIn(reader.Said()).size();
  Program driver = Start(TRACKER_CLIENT, robot.port(), {"10"});
  ASSERT_TRUE(
      reader.Says([&](const std::string& said) { return PlacesIn(said).size() > seen + 600; }));
  driver.End();
  Eigen::Vector3d least = Eigen::Vector3d::Constant(1e9), most = -least;
  for (const Eigen::Vector3d& p : PlacesIn(reader.Said())) {
    // On the circle, or between two of its places.
    EXPECT_NEAR(p.x(), p.z(), 0.5);
    EXPECT_GT(p.head<2>().norm(), 48.5);
    EXPECT_LT(p.head<2>().norm(), 50.5);
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  EXPECT_LT(least.maxCoeff(), -48.0);
  EXPECT_GT(most.minCoeff(), 48.0);
  robot.Interrupt();
  EXPECT_EQ(robot.Wait(), 0);
}

TEST_F(OpenIgtLinkExamples, SeeWhatControlPublishes) {
  ServedProgram robot({kPressScenario, "--serve", "0", "--duration", "120"});
  ASSERT_GT(robot.port(), 0);
  const auto device = [&](const char* name) {
    return "openigtlink: {port: " + std::to_string(robot.port()) + ", device: " + name + "}";
  };
  const int port = FreePort();
  const std::string session = folder_.Write(
      "session.yaml", PressSession(device, "rod-track", 120, false) +
                          "publish: {openigtlink: {port: " + std::to_string(port) + "}}\n");
  const Program control(Path("control.txt"), {FLEXTIP_PROGRAM, "control", session, "-o",
                                              Path("run"), "--duration", "60", "--wait"});
  ASSERT_TRUE(IsListenedTo(port)) << control.Said();
  const Program viewer = Start(RECEIVE_CLIENT, port);
  ASSERT_TRUE(viewer.Says([](const std::string& said) { return PlacesIn(said).size() > 60; }));
  ASSERT_TRUE(viewer.Says(Holds("Receiving : POLYDATA")));
  ASSERT_TRUE(viewer.Says(Holds("Receiving : NDARRAY")));
  // Nobody enables the robot: wrist and tip stay where the scenario starts.
  const Eigen::Vector3d wrist(-245.7, 0.0, 342.1), tip(245.7, 0.0, -2.1);
  int at_wrist = 0, at_tip = 0;
  for (const Eigen::Vector3d& p : PlacesIn(viewer.Said())) {
    at_wrist += (p - wrist).norm() < 0.5;
    at_tip += (p - tip).norm() < 3.0;
    EXPECT_LT(std::min((p - wrist).norm(), (p - tip).norm()), 3.0) << p.transpose();
  }
  EXPECT_GT(at_wrist, 20);
  EXPECT_GT(at_tip, 20);
}

}  // namespace
}  // namespace flextip
