// Two nodes over DDS, and peers that misbehave.
#include <dds/dds.h>
#include <gmock/gmock.h>
#include <ros2.h>

#include <limits>
#include <optional>
#include <thread>

#include "core/error.h"
#include "live/dds/domain.h"
#include "live/dds/node.h"
#include "tests/live/dds/domain_of_tests.h"
#include "tests/live/inbox.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Kind = WireEvent::Kind;

constexpr TimeNs kTime_ns = 1'700'000'000'000'000'000;
constexpr TimeNs kDay_ns = TimeNs{86'400} * 1'000'000'000;
const char* const kMeasured = "PSM1/measured_cp";
const char* const kServo = "PSM1/servo_cp";
const char* const kState = "PSM1/operating_state";
const char* const kCommand = "PSM1/state_command";

Ros2Topic TopicOf(const char* name, Content content) { return {name, Ros2TypesFor(content)}; }

/// What control has of a robot, and the robot's side of it.
Ros2Setup Controller() {
  Ros2Setup setup;
  setup.domain = DomainOfTests();
  setup.in = {TopicOf(kMeasured, Content::kPose), TopicOf(kState, Content::kState)};
  setup.out = {TopicOf(kServo, Content::kPose), TopicOf(kCommand, Content::kText)};
  return setup;
}
Ros2Setup Robot() {
  Ros2Setup setup = Controller();
  std::swap(setup.in, setup.out);
  setup.one_commander = true;
  return setup;
}

WireMessage PoseAt(const char* topic, TimeNs t_ns, double x_m = 0.1) {
  return {topic, t_ns, WireTransform{{Eigen::Matrix3d::Identity(), {x_m, 0.2, 0.3}}}};
}

/// A node and what it was given.
struct End {
  explicit End(const Ros2Setup& setup) : node(setup, inbox.OnMessage(), inbox.OnEvent()) {}
  Inbox inbox;
  Ros2Node node;
};

/// Sends until the reader is there, which nobody is told of.
bool SendWhenThere(Ros2Node& node, const WireMessage& message) {
  for (int i = 0; i < 1000; ++i) {
    if (node.IsThere(message.device)) return node.Send(message);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Writes structs as they are, which a node refuses to.
class RawWriter {
 public:
  RawWriter(const char* topic, const dds_topic_descriptor_t& type)
      : domain_(Ros2Domain::Open(DomainOfTests(), "lo", false)),
        participant_(domain_->NewParticipant()) {
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    const dds_entity_t made = dds_create_topic(participant_, &type, topic, nullptr, nullptr);
    writer_ = dds_create_writer(participant_, made, qos, nullptr);
    dds_delete_qos(qos);
  }
  ~RawWriter() { dds_delete(participant_); }
  RawWriter(const RawWriter&) = delete;
  RawWriter& operator=(const RawWriter&) = delete;
  void Write(const void* sample) const { EXPECT_EQ(dds_write(writer_, sample), DDS_RETCODE_OK); }

 private:
  std::shared_ptr<Ros2Domain> domain_;
  DdsHandle participant_, writer_ = 0;
};

geometry_msgs_msg_dds__PoseStamped_ GoodPose(std::uint32_t nanosec) {
  geometry_msgs_msg_dds__PoseStamped_ sample{};
  sample.header.stamp = {1'700'000'000, nanosec};
  sample.pose.position = {0.1, 0.2, 0.3};
  sample.pose.orientation.w = 1.0;
  return sample;
}

TEST(Ros2Node, MessagesGoBothWays) {
  End robot(Robot()), control(Controller());
  ASSERT_TRUE(SendWhenThere(robot.node, PoseAt(kMeasured, kTime_ns)));
  ASSERT_TRUE(SendWhenThere(robot.node, {kState, kTime_ns, WireText{"PAUSED homed"}}));
  ASSERT_TRUE(SendWhenThere(control.node, PoseAt(kServo, kTime_ns + 1)));
  ASSERT_TRUE(SendWhenThere(control.node, {kCommand, kTime_ns, WireText{"enable"}}));
  ASSERT_TRUE(control.inbox.Await(2));
  ASSERT_TRUE(robot.inbox.Await(2));
  EXPECT_EQ(control.inbox.Messages()[0].device, kMeasured);
  EXPECT_EQ(std::get<WireTransform>(control.inbox.Messages()[0].body).T_RD.p,
            Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(std::get<WireText>(control.inbox.Messages()[1].body).text, "PAUSED homed");
  EXPECT_TRUE(robot.node.HasCommander());
  EXPECT_EQ(control.node.Counts().passed, 2);
}

TEST(Ros2Node, AnAbsentPeerIsOneLineATopicAndNothingIsSentToIt) {
  End control(Controller());
  EXPECT_FALSE(control.node.Send(PoseAt(kServo, kTime_ns)));
  EXPECT_EQ(control.node.Counts().unsent, 1);
  EXPECT_THAT(control.inbox.AwaitLine("nobody sends PSM1/measured_cp"), StartsWith("ros2 domain"));
  EXPECT_NE(control.inbox.AwaitLine("nobody reads PSM1/state_command"), "");
  EXPECT_EQ(control.inbox.Events(Kind::kLost), 4);
}

TEST(Ros2Node, APeerThatGoesAndReturnsIsSaidAndHasATimeOfItsOwn) {
  auto robot = std::make_optional<End>(Robot());
  End control(Controller());
  ASSERT_TRUE(SendWhenThere(robot->node, PoseAt(kMeasured, kTime_ns)));
  ASSERT_TRUE(control.inbox.Await(1));
  robot.reset();
  EXPECT_NE(control.inbox.AwaitLine("PSM1/measured_cp is not sent any more"), "");
  EXPECT_NE(control.inbox.AwaitLine("PSM1/servo_cp is not read any more"), "");
  EXPECT_FALSE(control.node.Send(PoseAt(kServo, kTime_ns)));
  robot.emplace(Robot());
  ASSERT_TRUE(SendWhenThere(robot->node, PoseAt(kMeasured, kTime_ns - kDay_ns)));
  EXPECT_TRUE(control.inbox.Await(2));
  EXPECT_TRUE(SendWhenThere(control.node, PoseAt(kServo, kTime_ns + 1)));
  EXPECT_TRUE(robot->inbox.Await(1));
}

TEST(Ros2Node, YesterdaysAndRepeatedTimesAreCountedAndDropped) {
  End robot(Robot()), control(Controller());
  ASSERT_TRUE(SendWhenThere(robot.node, PoseAt(kMeasured, kTime_ns)));
  robot.node.Send(PoseAt(kMeasured, kTime_ns - kDay_ns));
  robot.node.Send(PoseAt(kMeasured, kTime_ns));
  robot.node.Send(PoseAt(kMeasured, kTime_ns + 1));
  ASSERT_TRUE(control.inbox.Await(2));
  EXPECT_EQ(control.inbox.Messages()[1].t_ns, kTime_ns + 1);
  EXPECT_EQ(control.node.Counts().out_of_order, 1);
  EXPECT_EQ(control.node.Counts().repeated, 1);
  EXPECT_THAT(control.inbox.AwaitEvent(Kind::kRefused),
              HasSubstr("PSM1/measured_cp: found the time 1699913600000000000 after "
                        "1700000000000000000"));
}

TEST(Ros2Node, DamagedPosesAreOneLineEachAndGoNoFurther) {
  End control(Controller());
  const RawWriter writer("rt/PSM1/measured_cp", geometry_msgs_msg_dds__PoseStamped__desc);
  control.inbox.AwaitLine("PSM1/measured_cp is sent");
  auto nan = GoodPose(1), long_q = GoodPose(2), good = GoodPose(3);
  nan.pose.position.x = std::numeric_limits<double>::quiet_NaN();
  long_q.pose.orientation.w = 2.0;
  for (const auto* const sample : {&nan, &long_q, &good}) writer.Write(sample);
  ASSERT_TRUE(control.inbox.Await(1));
  EXPECT_EQ(control.inbox.Messages()[0].t_ns, kTime_ns + 3);
  EXPECT_EQ(control.node.Counts().refused, 2);
  EXPECT_EQ(control.inbox.Events(Kind::kRefused), 2);
  EXPECT_THAT(control.inbox.AwaitLine("nan"), StartsWith("ros2 domain"));
  EXPECT_THAT(control.inbox.AwaitLine("norm 2"), HasSubstr("PSM1/measured_cp"));
}

TEST(Ros2Node, AFloodOfDamageIsCountedAndSaidInFewLines) {
  End control(Controller());
  const RawWriter writer("rt/PSM1/measured_cp", geometry_msgs_msg_dds__PoseStamped__desc);
  control.inbox.AwaitLine("PSM1/measured_cp is sent");
  auto damaged = GoodPose(1);
  damaged.pose.orientation.w = 0.0;
  constexpr int kFlood = 5000;
  for (int i = 0; i < kFlood; ++i) writer.Write(&damaged);
  const auto good = GoodPose(2);
  writer.Write(&good);
  ASSERT_TRUE(control.inbox.Await(1));
  EXPECT_GT(control.node.Counts().refused, 0);  // the last 10 are kept, as ROS 2's default
  EXPECT_LT(control.inbox.Events(Kind::kRefused), 200);
}

TEST(Ros2Node, ATypeThatIsNotAskedForIsNotRead) {
  End control(Controller());
  const RawWriter writer("rt/PSM1/measured_cp", std_msgs_msg_dds__String__desc);
  EXPECT_NE(control.inbox.AwaitLine("nobody sends PSM1/measured_cp"), "");
}

TEST(Ros2Node, AStampOfZeroIsSaidToBeInvalid) {
  End robot(Robot()), control(Controller());
  ASSERT_TRUE(SendWhenThere(robot.node, PoseAt(kMeasured, 0)));
  ASSERT_TRUE(control.inbox.Await(1));
  EXPECT_EQ(control.inbox.Messages()[0].t_ns, 0);
  EXPECT_THAT(control.inbox.AwaitEvent(Kind::kRefused), HasSubstr("the stamp 0"));
}

TEST(Ros2Node, OneParticipantCommandsUntilItLeaves) {
  End robot(Robot());
  auto first = std::make_optional<End>(Controller());
  End second(Controller());
  ASSERT_TRUE(SendWhenThere(first->node, PoseAt(kServo, kTime_ns)));
  ASSERT_TRUE(robot.inbox.Await(1));
  ASSERT_TRUE(SendWhenThere(second.node, PoseAt(kServo, kTime_ns + 1)));
  EXPECT_THAT(robot.inbox.AwaitEvent(Kind::kRefused), HasSubstr("another participant commands"));
  first.reset();
  for (int i = 0; i < 1000 && robot.node.HasCommander(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(robot.node.HasCommander());
  ASSERT_TRUE(second.node.Send(PoseAt(kServo, kTime_ns + 2)));
  EXPECT_TRUE(robot.inbox.Await(2));
}

/// Lockstep: what is sent before anybody reads comes whole and in order, the last topic last.
TEST(Ros2Node, InLockstepNothingThatWasSentBeforeIsLost) {
  constexpr int kSamples = 100;
  Ros2Setup of_robot = Robot(), of_control = Controller();
  for (Ros2Setup* const setup : {&of_robot, &of_control}) setup->lockstep = true;
  of_robot.out.push_back(TopicOf("lockstep", Content::kText));
  of_control.in.push_back(TopicOf("lockstep", Content::kText));
  of_control.last_in = 2;
  of_control.opens_last_in_late = true;
  of_control.last_out = 0;
  End robot(of_robot);
  for (int i = 0; i < kSamples; ++i) robot.node.Send(PoseAt(kMeasured, kTime_ns + i));
  robot.node.Send({kState, kTime_ns, WireText{"PAUSED homed"}});
  End control(of_control);
  for (int i = 0; i < 1000 && !robot.node.IsThere("lockstep"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(robot.node.WaitForReaders(std::chrono::seconds(10)));
  EXPECT_TRUE(robot.node.Send({"lockstep", kTime_ns, WireText{"cycle 0"}}));
  ASSERT_TRUE(control.inbox.Await(kSamples + 2));
  const auto messages = control.inbox.Messages();
  EXPECT_EQ(messages.back().device, "lockstep");
  for (int i = 0; i < kSamples; ++i)
    EXPECT_EQ(messages[static_cast<std::size_t>(i)].t_ns, kTime_ns + i);
  EXPECT_TRUE(control.node.Send({kCommand, kTime_ns, WireText{"enable"}}));
  EXPECT_TRUE(control.node.Send(PoseAt(kServo, kTime_ns)));
  EXPECT_TRUE(robot.inbox.Await(2));
}

TEST(Ros2Node, ADomainHasOneNetworkAndNamesThatAreNoneAreRefused) {
  End control(Controller());
  Ros2Setup other = Controller();
  other.network = "eth0";
  EXPECT_THROW(End{other}, WorkError);
  other.domain = DomainOfTests() + 100;
  other.network = "lo\"/><Evil";
  EXPECT_THROW(End{other}, InputError);
}

}  // namespace
}  // namespace flextip::live
