// The listener for datagrams, and senders that misbehave.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "core/error.h"
#include "live/udp/listener.h"
#include "live/udp/sender.h"
#include "tests/live/inbox.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;
using Kind = WireEvent::Kind;

constexpr TimeNs kTime_ns = 1'700'000'000'000'000'000;
constexpr TimeNs kSecond_ns = 1'000'000'000;

/// A socket of the test's own at an address of this machine.
class Sender {
 public:
  explicit Sender(const char* from = "127.0.0.1") : fd_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    ::inet_pton(AF_INET, from, &address.sin_addr);
    ::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    socklen_t size = sizeof address;
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~Sender() { ::close(fd_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;
  int port() const { return port_; }
  void Send(int port, const std::string& text) const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
    ::sendto(fd_, text.data(), text.size(), 0, reinterpret_cast<sockaddr*>(&address),
             sizeof address);
  }

 private:
  int fd_, port_ = 0;
};

std::string PoseText(TimeNs t_ns) {
  return PoseAsJson({"measured_cp", t_ns, WireTransform{{Eigen::Matrix3d::Identity(), {1, 2, 3}}}});
}

class UdpListening : public testing::Test {
 protected:
  static int FreePort() { return Sender().port(); }
  const int port_ = FreePort();
  Inbox inbox_;
  UdpListener listener_{"127.0.0.1", port_, inbox_.OnMessage(), inbox_.OnEvent()};
};

TEST_F(UdpListening, PosesOfTheSenderAreRead) {
  const UdpSender sender(port_);
  ASSERT_TRUE(sender.Send({"PSM1/measured_cp", kTime_ns, WireTransform{}}));
  ASSERT_TRUE(inbox_.Await(1));
  EXPECT_EQ(inbox_.Messages()[0].device, "measured_cp");
  EXPECT_EQ(inbox_.Messages()[0].t_ns, kTime_ns);
  EXPECT_THAT(inbox_.AwaitEvent(Kind::kConnected), HasSubstr("from 127.0.0.1: sends"));
}

TEST_F(UdpListening, GarbageIsOneLineWithItsSenderAndGoesNoFurther) {
  const Sender sender;
  sender.Send(port_, "GET / HTTP/1.1");
  EXPECT_EQ(inbox_.AwaitLine("no JSON object"),
            fmt::format("udp 127.0.0.1:{} from 127.0.0.1: no JSON object", port_));
  sender.Send(port_, std::string(20'000, '{'));
  EXPECT_NE(inbox_.AwaitLine("more than 16384 bytes"), "");
  sender.Send(port_, PoseText(kTime_ns));
  ASSERT_TRUE(inbox_.Await(1));
  EXPECT_EQ(listener_.Counts().refused, 2);
  EXPECT_EQ(inbox_.Messages().size(), 1u);
}

TEST_F(UdpListening, AFloodIsSaidInFewLines) {
  const Sender sender;
  for (int i = 0; i < 5000; ++i) sender.Send(port_, "x");
  sender.Send(port_, PoseText(kTime_ns));
  for (int i = 0; i < 100 && inbox_.Messages().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    sender.Send(port_, PoseText(kTime_ns));  // the system may have dropped the first
  }
  EXPECT_EQ(inbox_.Messages().size(), 1u);
  EXPECT_LT(inbox_.Events(Kind::kRefused), 200);
}

TEST_F(UdpListening, YesterdaysAndRepeatedTimesAreCountedAndDropped) {
  const Sender sender;
  for (const TimeNs t_ns :
       {kTime_ns, kTime_ns - 86'400 * kSecond_ns, kTime_ns, kTime_ns + kSecond_ns}) {
    sender.Send(port_, PoseText(t_ns));
  }
  ASSERT_TRUE(inbox_.Await(2));
  EXPECT_EQ(inbox_.Messages()[1].t_ns, kTime_ns + kSecond_ns);
  EXPECT_EQ(listener_.Counts().out_of_order, 1);
  EXPECT_EQ(listener_.Counts().repeated, 1);
  EXPECT_THAT(inbox_.AwaitEvent(Kind::kRefused),
              HasSubstr("measured_cp: found the time 1699913600000000000 after "
                        "1700000000000000000"));
}

TEST_F(UdpListening, OneAddressIsHeardUntilItIsSilent) {
  const Sender first, stranger("127.0.0.2");
  first.Send(port_, PoseText(kTime_ns));
  ASSERT_TRUE(inbox_.Await(1));
  stranger.Send(port_, PoseText(kTime_ns + kSecond_ns));
  EXPECT_THAT(inbox_.AwaitEvent(Kind::kRefused),
              HasSubstr("from 127.0.0.2: not heard while 127.0.0.1 sends"));
  EXPECT_THAT(inbox_.AwaitEvent(Kind::kLost), HasSubstr("from 127.0.0.1: no pose for a second"));
  stranger.Send(port_, PoseText(kTime_ns - kSecond_ns));  // it has a time of its own
  EXPECT_TRUE(inbox_.Await(2));
  EXPECT_THAT(inbox_.AwaitEvent(Kind::kConnected, 2), HasSubstr("127.0.0.2"));
}

TEST_F(UdpListening, SilenceFromTheBeginningIsSaidOnce) {
  EXPECT_THAT(inbox_.AwaitEvent(Kind::kLost), HasSubstr("no pose for a second"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(inbox_.Events(Kind::kLost), 1);
}

TEST_F(UdpListening, PortsThatAreTakenAndAddressesThatAreNoneAreRefused) {
  EXPECT_THROW(UdpListener("127.0.0.1", port_, inbox_.OnMessage(), inbox_.OnEvent()), WorkError);
  EXPECT_THROW(UdpListener("nowhere", port_, inbox_.OnMessage(), inbox_.OnEvent()), WorkError);
}

TEST(UdpSenders, WhatIsNoPoseIsNotSent) {
  EXPECT_THROW(PoseAsJson({"a", kTime_ns, WireText{"x"}}), InputError);
  EXPECT_THROW(UdpSender(0), InputError);
  EXPECT_THROW(UdpSender(70000), InputError);
}

}  // namespace
}  // namespace flextip::live
