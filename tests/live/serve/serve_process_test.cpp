// flextip simulate --serve in a process of its own, and a client that is the OpenIGTLink library's.
#include <gmock/gmock.h>
#include <igtlClientSocket.h>
#include <igtlMessageHeader.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/time_series.h"
#include "tests/live/serve/served_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kScenario = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/press.yaml";

/// A message as it came, and what of it the tests read.
struct Received {
  std::string type, device, text;
  unsigned seconds = 0, fraction = 0;
  float p_mm[3] = {0, 0, 0};
  std::vector<char> bytes;
};

/// A client by the library alone.
class PeerClient {
 public:
  explicit PeerClient(int port) : socket_(igtl::ClientSocket::New()) {
    connected_ = socket_->ConnectToServer("127.0.0.1", port) == 0;
    socket_->SetReceiveTimeout(20'000);
  }
  ~PeerClient() { socket_->CloseSocket(); }

  bool IsConnected() const { return connected_; }

  bool Receive(Received& received) {
    auto header = igtl::MessageHeader::New();
    header->InitPack();
    if (socket_->Receive(header->GetPackPointer(), header->GetPackSize()) != header->GetPackSize())
      return false;
    Append(received, header->GetPackPointer(), header->GetPackSize());
    header->Unpack();
    received.type = header->GetDeviceType();
    received.device = header->GetDeviceName();
    header->GetTimeStamp(&received.seconds, &received.fraction);
    if (received.type == "TRANSFORM") return ReceiveTransform(header, received);
    if (received.type == "STRING") return ReceiveString(header, received);
    std::vector<char> body(static_cast<std::size_t>(header->GetBodySizeToRead()));
    if (socket_->Receive(body.data(), static_cast<int>(body.size())) !=
        static_cast<int>(body.size())) {
      return false;
    }
    Append(received, body.data(), static_cast<int>(body.size()));
    return true;
  }

  void Command(const std::string& text, unsigned seconds, unsigned fraction) {
    auto message = igtl::StringMessage::New();
    message->SetString(text.c_str());
    Send(*message, "PSM1/state_command", seconds, fraction);
  }
  void Servo(const float (&p_mm)[3], unsigned seconds, unsigned fraction) {
    auto message = igtl::TransformMessage::New();
    igtl::Matrix4x4 matrix;
    igtl::IdentityMatrix(matrix);
    for (int i = 0; i < 3; ++i) matrix[i][3] = p_mm[i];
    message->SetMatrix(matrix);
    Send(*message, "PSM1/servo_cp", seconds, fraction);
  }

 private:
  static void Append(Received& received, const void* from, int size) {
    const auto* const bytes = static_cast<const char*>(from);
    received.bytes.insert(received.bytes.end(), bytes, bytes + size);
  }
  template <class Message>
  bool ReceiveBody(igtl::MessageHeader::Pointer& header, Message& message, Received& received) {
    message->SetMessageHeader(header);
    message->AllocatePack();
    const int size = message->GetPackBodySize();
    if (socket_->Receive(message->GetPackBodyPointer(), size) != size) return false;
    Append(received, message->GetPackBodyPointer(), size);
    return (message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY) != 0;
  }
  bool ReceiveTransform(igtl::MessageHeader::Pointer& header, Received& received) {
    auto message = igtl::TransformMessage::New();
    if (!ReceiveBody(header, message, received)) return false;
    igtl::Matrix4x4 matrix;
    message->GetMatrix(matrix);
    for (int i = 0; i < 3; ++i) received.p_mm[i] = matrix[i][3];
    return true;
  }
  bool ReceiveString(igtl::MessageHeader::Pointer& header, Received& received) {
    auto message = igtl::StringMessage::New();
    if (!ReceiveBody(header, message, received)) return false;
    received.text = message->GetString();
    return true;
  }
  void Send(igtl::MessageBase& message, const char* device, unsigned seconds, unsigned fraction) {
    message.SetDeviceName(device);
    message.SetTimeStamp(seconds, fraction);
    message.Pack();
    socket_->Send(message.GetPackPointer(), message.GetPackSize());
  }

  igtl::ClientSocket::Pointer socket_;
  bool connected_ = false;
};

/// The time now, later at each call.
std::pair<unsigned, unsigned> Stamp() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const double s = std::chrono::duration<double>(now).count();
  const double whole = std::floor(s);
  return {static_cast<unsigned>(whole), static_cast<unsigned>((s - whole) * 4294967296.0)};
}

TEST(ServedRobot, IsHomedEnabledReadAndDrivenByAPeer) {
  ServedProgram program({kScenario, "--serve", "0", "--duration", "120"});
  ASSERT_GT(program.port(), 0);
  PeerClient client(program.port());
  ASSERT_TRUE(client.IsConnected());
  const auto command = [&](const char* text) {
    const auto [seconds, fraction] = Stamp();
    client.Command(text, seconds, fraction);
  };
  command("home");
  command("enable");
  Received received;
  do {
    received = {};
    ASSERT_TRUE(client.Receive(received));
  } while (received.device != "PSM1/operating_state" || received.text != "ENABLED homed");

  // Means over samples: the encoders have a noise of 0.05 mm.
  const auto mean = [&](float(&p_mm)[3]) {
    constexpr int kSamples = 40;
    for (float& p : p_mm) p = 0.0f;
    for (int count = 0; count < kSamples;) {
      Received sample;
      ASSERT_TRUE(client.Receive(sample));
      if (sample.device != "PSM1/measured_cp") continue;
      for (int i = 0; i < 3; ++i) p_mm[i] += sample.p_mm[i] / kSamples;
      ++count;
    }
  };
  float before[3], after[3];
  mean(before);
  const float start_mm[3] = {-245.7f, 0.0f, 342.1f};  // the scenario's
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(before[i], start_mm[i], 0.04);
  const float target[3] = {start_mm[0], start_mm[1], start_mm[2] + 1.0f};
  const auto [seconds, fraction] = Stamp();
  client.Servo(target, seconds, fraction);
  mean(after);  // the robot arrives within the first of these
  mean(after);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(after[i], target[i], 0.04);
  command("pause");
  do {
    received = {};
    ASSERT_TRUE(client.Receive(received));
  } while (received.text != "PAUSED homed");
  program.Interrupt();
  EXPECT_EQ(program.Wait(), 0);
  EXPECT_THAT(program.out(), HasSubstr("PAUSED homed"));
  EXPECT_THAT(program.out(), HasSubstr("set-points followed                     1"));
}

/// A session in lockstep: everything that was received, and where the wrist ended.
struct LockstepSession {
  std::vector<char> bytes;
  float last_mm[3] = {0, 0, 0};
  int cycles = 0, exit_code = -1;
  std::string out;
};

LockstepSession RunLockstep(const std::vector<std::string>& more, bool enable) {
  constexpr int kCycles = 60, kMoveFrom = 30;
  std::vector<std::string> arguments = {kScenario, "--serve", "0", "--lockstep"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  ServedProgram program(arguments);
  LockstepSession session;
  {
    PeerClient client(program.port());
    EXPECT_TRUE(client.IsConnected());
    while (session.cycles < kCycles) {
      Received received;
      if (!client.Receive(received)) break;
      session.bytes.insert(session.bytes.end(), received.bytes.begin(), received.bytes.end());
      if (received.device == "PSM1/measured_cp")
        std::copy(received.p_mm, received.p_mm + 3, session.last_mm);
      if (received.device != "lockstep") continue;
      EXPECT_EQ(received.text, "cycle " + std::to_string(session.cycles));
      if (session.cycles == 0 && enable) {
        client.Command("enable", received.seconds, received.fraction);
        client.Command("home", received.seconds, received.fraction);
      }
      // The last is not answered: whether its answer or the end came first would be chance.
      if (session.cycles + 1 == kCycles) {
        ++session.cycles;
        break;
      }
      const float up_mm = 0.1f * static_cast<float>(std::max(0, session.cycles - kMoveFrom));
      const float p_mm[3] = {-245.7f, 0.0f, 342.1f + up_mm};
      client.Servo(p_mm, received.seconds, received.fraction);
      ++session.cycles;
    }
  }
  session.exit_code = program.Wait();
  session.out = program.out();
  return session;
}

/// The files of a folder but for those that tell of time and place.
std::map<std::string, std::string> Files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".csv" && entry.path().extension() != ".yaml") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    files[fs::relative(entry.path(), folder)] = {std::istreambuf_iterator<char>(file), {}};
  }
  return files;
}

TEST(ServedRobot, InLockstepEqualCommandsGiveEqualBytes) {
  const fs::path folder = fs::path(testing::TempDir()) / "flextip_lockstep";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const LockstepSession first = RunLockstep({"-o", (folder / "a").string()}, true);
  const LockstepSession second = RunLockstep({"-o", (folder / "b").string()}, true);
  EXPECT_EQ(first.cycles, 60);
  EXPECT_EQ(first.exit_code, 0) << first.out;
  EXPECT_GT(first.bytes.size(), 50'000u);
  EXPECT_EQ(first.bytes, second.bytes);
  const auto a = Files(folder / "a"), b = Files(folder / "b");
  EXPECT_TRUE(a.contains("truth0/data.csv"));
  EXPECT_TRUE(a.contains("wrist0/data.csv"));
  EXPECT_TRUE(a.contains("command0/data.csv"));
  EXPECT_EQ(a, b);
  EXPECT_NEAR(first.last_mm[2], 342.1f + 2.8f, 0.5f);  // it followed
  fs::remove_all(folder);
}

TEST(ServedRobot, InLockstepSetPointsOfARobotThatIsNotEnabledOnlyLetTimeGoOn) {
  const LockstepSession session = RunLockstep({}, false);
  EXPECT_EQ(session.cycles, 60);
  EXPECT_EQ(session.exit_code, 0);
  EXPECT_NEAR(session.last_mm[2], 342.1f, 0.3f);
  EXPECT_THAT(session.out, HasSubstr("(59 not followed)"));
}

TEST(ServedRobot, InLockstepWithoutAClientLeavesNothing) {
  const fs::path folder = fs::path(testing::TempDir()) / "flextip_no_client";
  fs::remove_all(folder);
  ServedProgram program({kScenario, "--serve", "0", "--lockstep", "-o", folder.string()});
  ASSERT_GT(program.port(), 0);
  program.Interrupt();
  EXPECT_EQ(program.Wait(), 1);
  EXPECT_FALSE(fs::exists(folder));
}

TEST(ServedRobot, EndsAfterItsDuration) {
  ServedProgram program({kScenario, "--serve", "0", "--duration", "0.3"});
  ASSERT_GT(program.port(), 0);
  EXPECT_EQ(program.Wait(), 0);
  EXPECT_THAT(program.out(), HasSubstr("0.300 s"));
}

}  // namespace
}  // namespace flextip
