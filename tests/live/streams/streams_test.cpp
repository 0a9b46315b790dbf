// The frames of a robot, its base and its tool's, on their way in and out.
#include "live/streams/streams.h"

#include <gtest/gtest.h>

#include <iomanip>
#include <memory>
#include <sstream>

#include "core/error.h"
#include "core/rotation.h"
#include "live/loop/control_loop.h"
#include "live/loop/set_point.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

const Pose kT_RB{ExpRotation(Eigen::Vector3d(0.3, -0.8, 1.1)), {0.2, -0.1, 0.4}};
const Pose kT_DW{ExpRotation(Eigen::Vector3d(0.0, -1.5, 0.4)), {0.01, 0.0, 0.09}};
const Pose kT_BD{ExpRotation(Eigen::Vector3d(0.1, 0.2, -0.3)), {-0.05, 0.3, 0.25}};

std::string WithFrames(const std::string& T_RB, const std::string& T_DW) {
  std::string text = SessionText();
  const std::string robot = "robot:\n";
  return text.replace(text.find(robot), robot.size(),
                      robot + "  T_RB: " + T_RB + "\n  T_DW: " + T_DW + "\n");
}

std::string Rows(const Pose& T) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> m = T.Matrix();
  std::string text = "{rows: 4, cols: 4, data: [";
  for (int i = 0; i < 16; ++i)
    text += (i > 0 ? ", " : "") +
            (std::ostringstream() << std::setprecision(17) << m(i / 4, i % 4)).str();
  return text + "]}";
}

/// A robot that is where it was told to be last, in its own frame; its state never changes.
class StillRobot : public Peers {
 public:
  explicit StillRobot(Pose& commanded) : commanded_(commanded) {}
  bool Send(const Address& /*address*/, const WireMessage& message) override {
    if (const auto* pose = std::get_if<WireTransform>(&message.body)) commanded_ = pose->T_RD;
    return true;
  }

 private:
  Pose& commanded_;
};

TEST(RobotFrame, TheWristIsPlacedInR) {
  const Session session = ReadSession(WriteSession(WithFrames(Rows(kT_RB), Rows(kT_DW))));
  Streams streams(session);
  WireTransform body;
  body.T_RD = kT_BD;
  streams.Take(StreamName::kWrist, {"", 1'000, body}, 1'000);
  const auto wrist = streams.Look().wrist;
  ASSERT_TRUE(wrist);
  const Pose expected = kT_RB * kT_BD * kT_DW;
  EXPECT_LT((wrist->value.p_RW - expected.p).norm(), 1e-12);
  EXPECT_LT((wrist->value.q_RW->toRotationMatrix() - expected.R).norm(), 1e-12);
}

TEST(RobotFrame, ASetPointGoesOutInTheRobotsFrame) {
  const Session session = ReadSession(WriteSession(WithFrames(Rows(kT_RB), Rows(kT_DW))));
  Pose commanded;
  LoopOptions options;
  options.duration_s = 0.1;
  const OpenPeers open = [&](const Session& /*session*/, const PeerHandlers& handlers) {
    WireTransform body;
    body.T_RD = kT_BD;
    handlers.message(session.Of(StreamName::kWrist)->address,
                     {session.Of(StreamName::kWrist)->address.device, Now_ns(), body});
    return std::make_unique<StillRobot>(commanded);
  };
  RunLoop(session, options, nullptr, open);  // held: the wrist as measured is commanded
  EXPECT_LT((commanded.p - kT_BD.p).norm(), 1e-12);
  EXPECT_LT((commanded.R - kT_BD.R).norm(), 1e-12);
}

TEST(SetPoint, OfAStraightShaftKeepsItThroughThePort) {
  const Eigen::Vector3d p_RP(0.02, -0.01, 0.3), p_RW(-0.2, 0.05, 0.1), p_command(-0.17, 0.01, 0.12);
  constexpr double kLength_m = 0.6;
  const auto end_of = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return p + kLength_m * (p_RP - p).normalized();  // by the lever
  };
  const Pose T_RW{RotationWithoutTwist(Eigen::Vector3d::UnitX(), (p_RP - p_RW).normalized()), p_RW};
  const Pose T_WD{Eigen::Matrix3d::Identity(), {kLength_m, 0.0, 0.0}};
  EXPECT_LT(((T_RW * T_WD).p - end_of(p_RW)).norm(), 1e-12);
  EXPECT_LT(((SetPoint(T_RW, p_command, p_RP) * T_WD).p - end_of(p_command)).norm(), 1e-12);
}

TEST(SetPoint, AtThePortKeepsItsOrientation) {
  const Pose set_point = SetPoint(kT_BD, kT_BD.p, kT_BD.p);
  EXPECT_EQ(set_point.R, kT_BD.R);
  EXPECT_EQ(set_point.p, kT_BD.p);
}

TEST(RobotFrame, OfATurnedDeviceNeedsAnOrientation) {
  const Session session = ReadSession(WriteSession(WithFrames(Rows(kT_RB), Rows(kT_DW))));
  Streams streams(session);
  WireTransform body;
  body.T_RD = kT_BD;
  body.has_orientation = false;
  EXPECT_NE(streams.Take(StreamName::kWrist, {"", 1'000, body}, 1'000), "");
  EXPECT_FALSE(streams.Look().wrist);
}

TEST(RobotFrame, MustBeRigid) {
  const std::string stretched = "{rows: 4, cols: 4, data: [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}";
  EXPECT_THROW(ReadSession(WriteSession(WithFrames(stretched, Rows(kT_DW)))), InputError);
  EXPECT_THROW(ReadSession(WriteSession(WithFrames(Rows(kT_RB), stretched))), InputError);
}

}  // namespace
}  // namespace flextip::live
