// Session files of joints: what is read, and what is refused.
#include "live/joints/joint_session.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"

namespace flextip::live {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const char* const kSession = R"(format: flextip-session
version: 1
joints:
  desired: way
  measured: {ros2: {topic: /PSM1/measured_js, domain: 5}}
  command: {ros2: {topic: /PSM1/servo_jp, domain: 5}}
  state: {ros2: {topic: /PSM1/operating_state, domain: 5}}
  follow_limit: [0.1, 0.01]
model: model.yaml
)";

std::filesystem::path Written(const std::string& text) {
  const std::filesystem::path file =
      testing::TempDir() + "joint_session_" + std::to_string(getpid()) + ".yaml";
  std::ofstream(file) << text;
  return file;
}

std::string Complaint(const std::string& before, const std::string& after) {
  std::string text = kSession;
  text.replace(text.find(before), before.size(), after);
  try {
    ReadJointSession(Written(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(JointSession, IsRead) {
  const std::filesystem::path file = Written(kSession);
  EXPECT_TRUE(IsJointSession(file));
  const JointSession session = ReadJointSession(file);
  EXPECT_EQ(session.desired, file.parent_path() / "way");
  EXPECT_EQ(session.model, file.parent_path() / "model.yaml");
  EXPECT_EQ(session.command.device, "PSM1/servo_jp");
  EXPECT_EQ(session.command.content, Content::kJoints);
  EXPECT_TRUE(session.measured.SamePeer(session.command));
  EXPECT_FALSE(session.command_state);
  EXPECT_THAT(session.follow_limit, ElementsAre(0.1, 0.01));
  EXPECT_EQ(session.rate_hz, 500.0);
}

TEST(JointSession, WhatIsNoneIsRefused) {
  const std::string measured = "{ros2: {topic: /PSM1/measured_js, domain: 5}}";
  EXPECT_THAT(Complaint(measured, "{openigtlink: {port: 18944, device: a}}"),
              HasSubstr("does not carry this"));
  EXPECT_THAT(Complaint(measured, "{}"), HasSubstr("found no peer"));
  EXPECT_THAT(Complaint("version: 1", "version: 2"), HasSubstr("found 2, expected 1"));
  EXPECT_THAT(Complaint("  desired: way\n", ""), HasSubstr("desired"));
  EXPECT_THAT(Complaint("[0.1, 0.01]", "[0.1, -0.01]"), HasSubstr("found -0.01"));
  EXPECT_THAT(Complaint("follow_limit", "follow_limits"), HasSubstr("unknown key"));
  EXPECT_THAT(Complaint("  state:", "  rate_hz: 9e9\n  state:"), HasSubstr("rate_hz"));
}

}  // namespace
}  // namespace flextip::live
