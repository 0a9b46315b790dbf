// Client and server in one process, and peers that misbehave.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

#include "core/error.h"
#include "live/openigtlink/client.h"
#include "live/openigtlink/codec.h"
#include "live/openigtlink/server.h"
#include "tests/live/inbox.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;
using Kind = WireEvent::Kind;

/// A listening socket of the test's own, for peers that misbehave.
class RawServer {
 public:
  RawServer() : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    ::listen(fd_, 4);
    socklen_t size = sizeof address;
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~RawServer() {
    Hang();
    ::close(fd_);
  }
  int port() const { return port_; }
  void Accept() { client_ = ::accept(fd_, nullptr, nullptr); }
  void Send(const std::vector<std::uint8_t>& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t n = ::send(client_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (n <= 0) return;
      at += static_cast<std::size_t>(n);
    }
  }
  void Hang() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
  }

 private:
  int fd_, client_ = -1, port_ = 0;
};

WireMessage Numbers(const std::string& device, TimeNs t_ns, double value = 1.0) {
  return {device, t_ns, WireNumbers{{value}}};
}

TEST(OpenIgtLinkConnection, MessagesGoBothWays) {
  Inbox at_server, at_client;
  OpenIgtLinkServer server(0, false, at_server.OnMessage(), at_server.OnEvent());
  OpenIgtLinkClient client("127.0.0.1", server.port(), at_client.OnMessage(), at_client.OnEvent());
  at_client.AwaitEvent(Kind::kConnected);
  at_server.AwaitEvent(Kind::kConnected);
  const Pose pose{Eigen::Matrix3d::Identity(), {0.1, 0.2, 0.3}};
  EXPECT_TRUE(client.Send({"PSM1/servo_cp", 5, WireTransform{pose}}));
  EXPECT_EQ(server.Send(Numbers("strain0", 7, 0.25)), 1);
  Image image(640, 480, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = static_cast<std::uint8_t>(i * i);
  EXPECT_EQ(server.Send({"cam0", 8, WireImage{image}}), 1);
  ASSERT_TRUE(at_server.Await(1));
  ASSERT_TRUE(at_client.Await(2));
  const auto sent = std::get<WireTransform>(at_server.Messages()[0].body);
  EXPECT_LT((sent.T_RD.p - pose.p).norm(), 1e-8);
  EXPECT_EQ(std::get<WireNumbers>(at_client.Messages()[0].body).values[0], 0.25);
  EXPECT_EQ(std::get<WireImage>(at_client.Messages()[1].body).image.data, image.data);
  EXPECT_EQ(client.Counts().passed, 2);
  EXPECT_EQ(server.Counts().passed, 1);
}

TEST(OpenIgtLinkConnection, TheClientConnectsAgain) {
  Inbox at_client, at_server;
  auto server =
      std::make_optional<OpenIgtLinkServer>(0, false, at_server.OnMessage(), at_server.OnEvent());
  const int port = server->port();
  OpenIgtLinkClient client("127.0.0.1", port, at_client.OnMessage(), at_client.OnEvent());
  at_client.AwaitEvent(Kind::kConnected);
  at_server.AwaitEvent(Kind::kConnected);
  server->Send(Numbers("a", 100));
  ASSERT_TRUE(at_client.Await(1));
  server.reset();
  EXPECT_THAT(at_client.AwaitEvent(Kind::kLost), HasSubstr("closed"));
  EXPECT_FALSE(client.Send(Numbers("b", 1)));
  EXPECT_EQ(client.Counts().unsent, 1);
  std::this_thread::sleep_for(700ms);
  EXPECT_LE(at_client.Events(Kind::kLost), 2);  // refused connections are said once
  server.emplace(port, false, at_server.OnMessage(), at_server.OnEvent());
  EXPECT_FALSE(at_client.AwaitEvent(Kind::kConnected, 2).empty());
  at_server.AwaitEvent(Kind::kConnected, 2);
  server->Send(Numbers("a", 50));  // a new connection has a time of its own
  EXPECT_TRUE(at_client.Await(2));
}

TEST(OpenIgtLinkConnection, RepeatedAndOldMessagesAreCountedAndDropped) {
  Inbox at_client, at_server;
  OpenIgtLinkServer server(0, false, at_server.OnMessage(), at_server.OnEvent());
  OpenIgtLinkClient client("127.0.0.1", server.port(), at_client.OnMessage(), at_client.OnEvent());
  at_server.AwaitEvent(Kind::kConnected);
  for (const TimeNs t_ns : {10, 20, 20, 15, 30, 10}) server.Send(Numbers("a", t_ns));
  server.Send(Numbers("b", 1));
  ASSERT_TRUE(at_client.Await(4));
  EXPECT_EQ(client.Counts().passed, 4);
  EXPECT_EQ(client.Counts().repeated, 1);
  EXPECT_EQ(client.Counts().out_of_order, 2);
  EXPECT_THAT(at_client.AwaitEvent(Kind::kRefused), HasSubstr("found the time 20 after 20"));
}

TEST(OpenIgtLinkConnection, AStopInMidMessageIsALossAfterTwoSeconds) {
  RawServer peer;
  Inbox inbox;
  OpenIgtLinkClient client("127.0.0.1", peer.port(), inbox.OnMessage(), inbox.OnEvent());
  peer.Accept();
  const auto bytes = EncodeOpenIgtLink(Numbers("a", 1));
  peer.Send({bytes.begin(), bytes.begin() + 60});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THAT(inbox.AwaitEvent(Kind::kLost), HasSubstr("stopped in mid-message, after 60 bytes"));
  const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
  EXPECT_GT(waited.count(), 1.9);
  EXPECT_LT(waited.count(), 5.0);
  EXPECT_TRUE(inbox.Messages().empty());
}

TEST(OpenIgtLinkConnection, AnEndInMidMessageIsNamed) {
  RawServer peer;
  Inbox inbox;
  OpenIgtLinkClient client("127.0.0.1", peer.port(), inbox.OnMessage(), inbox.OnEvent());
  peer.Accept();
  const auto bytes = EncodeOpenIgtLink(Numbers("a", 1));
  peer.Send({bytes.begin(), bytes.begin() + 60});
  peer.Hang();
  EXPECT_THAT(inbox.AwaitEvent(Kind::kLost), HasSubstr("closed in mid-message"));
}

TEST(OpenIgtLinkConnection, MessagesInPiecesAreRead) {
  RawServer peer;
  Inbox inbox;
  OpenIgtLinkClient client("127.0.0.1", peer.port(), inbox.OnMessage(), inbox.OnEvent());
  peer.Accept();
  for (TimeNs t_ns = 1; t_ns <= 3; ++t_ns)
    for (const std::uint8_t byte : EncodeOpenIgtLink(Numbers("a", t_ns))) peer.Send({byte});
  EXPECT_TRUE(inbox.Await(3));
}

TEST(OpenIgtLinkConnection, GarbageEndsTheConnection) {
  RawServer peer;
  Inbox inbox;
  OpenIgtLinkClient client("127.0.0.1", peer.port(), inbox.OnMessage(), inbox.OnEvent());
  peer.Accept();
  const std::string text = "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
  peer.Send({text.begin(), text.end()});
  EXPECT_THAT(inbox.AwaitEvent(Kind::kLost), HasSubstr("sends no OpenIGTLink"));
  peer.Hang();
  peer.Accept();  // it comes again
  peer.Send(EncodeOpenIgtLink(Numbers("a", 1)));
  EXPECT_TRUE(inbox.Await(1));
  EXPECT_EQ(client.Counts().refused, 1);
}

TEST(OpenIgtLinkConnection, AFloodOfDamageIsCountedAndSaidInFewLines) {
  RawServer peer;
  Inbox inbox;
  OpenIgtLinkClient client("127.0.0.1", peer.port(), inbox.OnMessage(), inbox.OnEvent());
  peer.Accept();
  auto damaged = EncodeOpenIgtLink(Numbers("a", 1));
  damaged.back() ^= 1;
  std::vector<std::uint8_t> flood;
  constexpr int kFlood = 20'000;
  for (int i = 0; i < kFlood; ++i) flood.insert(flood.end(), damaged.begin(), damaged.end());
  peer.Send(flood);
  peer.Send(EncodeOpenIgtLink(Numbers("a", 2)));
  ASSERT_TRUE(inbox.Await(1));
  EXPECT_EQ(client.Counts().refused, kFlood);
  EXPECT_LT(inbox.Events(Kind::kRefused), 200);
}

TEST(OpenIgtLinkConnection, AFloodOfPosesIsReadWhole) {
  RawServer peer;
  std::atomic<int> read = 0;
  Inbox inbox;
  OpenIgtLinkClient client(
      "127.0.0.1", peer.port(), [&](WireMessage&&) { ++read; }, inbox.OnEvent());
  peer.Accept();
  constexpr int kPoses = 100'000;
  std::vector<std::uint8_t> flood;
  for (TimeNs t_ns = 1; t_ns <= kPoses; ++t_ns) {
    const auto one = EncodeOpenIgtLink({"PSM1/measured_cp", t_ns, WireTransform{}});
    flood.insert(flood.end(), one.begin(), one.end());
  }
  const auto begin = std::chrono::steady_clock::now();
  peer.Send(flood);
  while (read < kPoses && std::chrono::steady_clock::now() - begin < 30s)
    std::this_thread::sleep_for(1ms);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(read, kPoses);
  RecordProperty("messages_per_s", static_cast<int>(kPoses / took.count()));
}

TEST(OpenIgtLinkConnection, SendDoesNotWaitForAPeerThatDoesNotRead) {
  RawServer peer;
  Inbox inbox;
  OpenIgtLinkClient client("127.0.0.1", peer.port(), inbox.OnMessage(), inbox.OnEvent());
  peer.Accept();
  inbox.AwaitEvent(Kind::kConnected);
  const WireMessage large{"a", 1, WireNumbers{std::vector<double>(8000, 1.0)}};
  int sent = 0;
  std::chrono::duration<double> longest{};
  while (sent < 2000) {
    const auto begin = std::chrono::steady_clock::now();
    const bool taken = client.Send(large);
    longest =
        std::max<std::chrono::duration<double>>(longest, std::chrono::steady_clock::now() - begin);
    if (!taken) break;
    ++sent;
  }
  EXPECT_LT(sent, 2000);
  EXPECT_LT(longest.count(), 0.5);  // a blocking send would wait for ever
}

/// A connection from an address of this machine, with a message sent.
int Speak(const char* from, int port, const WireMessage& message) {
  const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  ::inet_pton(AF_INET, from, &address.sin_addr);
  EXPECT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const auto bytes = EncodeOpenIgtLink(message);
  EXPECT_EQ(::send(fd, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  return fd;
}

TEST(OpenIgtLinkServer, OneAddressCommandsUntilItLeaves) {
  Inbox at_server;
  OpenIgtLinkServer server(0, false, at_server.OnMessage(), at_server.OnEvent());
  const int first = Speak("127.0.0.1", server.port(), Numbers("a", 1));
  ASSERT_TRUE(at_server.Await(1));
  EXPECT_TRUE(server.HasCommander());
  const int stranger = Speak("127.0.0.2", server.port(), Numbers("b", 1));
  EXPECT_THAT(at_server.AwaitEvent(Kind::kRefused), HasSubstr("b: not taken while 127.0.0.1"));
  const int again = Speak("127.0.0.1", server.port(), Numbers("c", 1));
  ASSERT_TRUE(at_server.Await(2));
  EXPECT_EQ(at_server.Messages()[1].device, "c");
  EXPECT_EQ(server.Send(Numbers("d", 1)), 3);  // all are told
  ::close(first);
  at_server.AwaitEvent(Kind::kLost);
  EXPECT_TRUE(server.HasCommander());
  ::close(again);
  at_server.AwaitEvent(Kind::kLost, 2);
  EXPECT_FALSE(server.HasCommander());
  const auto bytes = EncodeOpenIgtLink(Numbers("b", 2));
  ::send(stranger, bytes.data(), bytes.size(), 0);
  ASSERT_TRUE(at_server.Await(3));
  EXPECT_EQ(at_server.Messages()[2].device, "b");
  ::close(stranger);
}

TEST(OpenIgtLinkServer, NewcomersAreGivenWhatIsKeptForThemOnce) {
  Inbox at_server, at_first, at_second;
  OpenIgtLinkServer server(0, false, at_server.OnMessage(), at_server.OnEvent());
  OpenIgtLinkClient first("127.0.0.1", server.port(), at_first.OnMessage(), at_first.OnEvent());
  at_server.AwaitEvent(Kind::kConnected);
  server.Send(Numbers("a", 1), true);
  server.ForgetKept();
  server.Send(Numbers("a", 2), true);
  ASSERT_TRUE(at_first.Await(2));
  OpenIgtLinkClient second("127.0.0.1", server.port(), at_second.OnMessage(), at_second.OnEvent());
  ASSERT_TRUE(at_second.Await(1));
  server.Send(Numbers("a", 3));
  ASSERT_TRUE(at_second.Await(2));
  EXPECT_EQ(at_second.Messages()[0].t_ns, 2);
  ASSERT_TRUE(at_first.Await(3));
  EXPECT_EQ(first.Counts().repeated, 0);
}

TEST(OpenIgtLinkServer, ListensOnThisMachineAlone) {
  Inbox inbox;
  OpenIgtLinkServer server(0, false, inbox.OnMessage(), inbox.OnEvent());
  const auto reaches = [&](const char* host) {
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
    ::inet_pton(AF_INET, host, &address.sin_addr);
    const bool reached = ::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
    ::close(fd);
    return reached;
  };
  EXPECT_TRUE(reaches("127.0.0.1"));
  EXPECT_FALSE(reaches("127.0.0.2"));  // every 127.x.x.x is this machine
  EXPECT_THROW(OpenIgtLinkServer(server.port(), false, inbox.OnMessage(), inbox.OnEvent()),
               WorkError);
}

TEST(OpenIgtLinkClient, RefusesPortsThatAreNone) {
  Inbox inbox;
  for (const int port : {-1, 0, 65536})
    EXPECT_THROW(OpenIgtLinkClient("127.0.0.1", port, inbox.OnMessage(), inbox.OnEvent()),
                 InputError);
}

}  // namespace
}  // namespace flextip::live
