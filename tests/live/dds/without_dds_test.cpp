// A build without Cyclone DDS says so, and reads sessions all the same.
#include <gmock/gmock.h>

#include "core/error.h"
#include "live/dds/node.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

TEST(WithoutDds, NodesSayThatThereIsNoRos2) {
  EXPECT_FALSE(HasRos2());
  try {
    const Ros2Node node(
        {}, [](WireMessage&&) {}, [](WireEvent&&) {});
    FAIL();
  } catch (const WorkError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("without ROS 2"));
    EXPECT_THAT(error.what(), testing::HasSubstr("cyclonedds-dev"));
  }
}

TEST(WithoutDds, SessionsOfRos2AreRead) {
  std::string text = SessionText();
  const std::string before = "openigtlink: {port: 18944, device: vision0}";
  text.replace(text.find(before), before.size(), "ros2: {topic: /vision0, domain: 5}");
  const Session session = ReadSession(WriteSession(text));
  EXPECT_STREQ(session.Of(StreamName::kTip)->address.protocol->key, "ros2");
}

}  // namespace
}  // namespace flextip::live
