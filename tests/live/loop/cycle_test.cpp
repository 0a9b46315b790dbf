// The cycle on a plant in process: it starts the robot, follows the path, holds, and replays.
#include "live/loop/cycle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "live/recorder/recorder.h"
#include "live/recorder/replay.h"
#include "recording/recording_reader.h"
#include "recording/text/text.h"
#include "tests/control/allocation_counter.h"
#include "tests/live/loop/peer.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

TEST(Delay, UnknownKeepsTheRobotDisabled) {
  Session session = ReadSession(WriteSession(SessionText()));
  session.streams[static_cast<std::size_t>(StreamName::kTip)].reset();
  session.camera.emplace().video = "0";  // stamps pictures as they arrive
  auto [last, told] = AfterOneSecond(session);
  EXPECT_FALSE(told);
  EXPECT_EQ(last.hold, Hold::kDelayUnknown);
  session.task.controller.kind = ControllerKind::kRodCalculate;  // does not follow the tip
  EXPECT_TRUE(AfterOneSecond(session).second);
  session.task.controller.kind = ControllerKind::kRodTrack;
  session.camera->latency_known = true;
  std::tie(last, told) = AfterOneSecond(session);
  EXPECT_TRUE(told);
  EXPECT_EQ(last.hold, Hold::kNone);
}

TEST(Delay, AKnownLatencyIsNotStale) {
  std::string text = SessionText();
  const std::string device = "device: vision0}";
  text.replace(text.find(device), device.size(), device + ", latency_s: 0.25, stale_s: 0.1");
  const Session session = ReadSession(WriteSession(text));
  EXPECT_EQ(AfterOneSecond(session).first.hold, Hold::kNone);
}

TEST_F(Running, StartsTheRobotFollowsThePathAndPausesIt) {
  RunUntilMoving();
  EXPECT_TRUE(peer.state.is_homed);
  const Eigen::Vector3d start = peer.Tip();
  for (int i = 0; i < 200 && !last.done; ++i) Step();
  EXPECT_TRUE(last.done);
  EXPECT_LT((peer.Tip() - start - Eigen::Vector3d(0, 0, -0.01)).norm(), 4e-4);
  for (int i = 0; i < 30; ++i) Step();
  EXPECT_EQ(last.hold, Hold::kStopped);
  EXPECT_EQ(peer.state.state, CrtkState::kPaused);
}

TEST_F(Running, HoldsWhereAStreamIsStaleAndResumesByItself) {
  RunUntilMoving();
  for (auto [there, hold] : {std::pair{&peer.tip_there, Hold::kStaleTip},
                             std::pair{&peer.wrist_there, Hold::kStaleWrist},
                             std::pair{&peer.strain_there, Hold::kSourceLost}}) {
    *there = false;
    for (int i = 0; i < 25; ++i) Step();
    EXPECT_EQ(last.hold, hold);
    const Eigen::Vector3d held = peer.Wrist();
    for (int i = 0; i < 10; ++i) Step();
    EXPECT_EQ(peer.Wrist(), held);
    *there = true;
    for (int i = 0; i < 20; ++i) Step();
    EXPECT_EQ(last.hold, Hold::kNone);
  }
}

TEST_F(Running, NamesALostSource) {
  RunUntilMoving();
  peer.Lose(static_cast<int>(StreamName::kStrain));
  Step();
  EXPECT_EQ(last.hold, Hold::kSourceLost);
  EXPECT_STREQ(Name(static_cast<StreamName>(last.held_by)), "strain0");
}

TEST_F(Running, AWrongTipIsLeftToTheOtherSensors) {
  RunUntilMoving();
  const Eigen::Vector3d start = peer.Tip();
  peer.tip_offset_m = 0.03;
  for (int i = 0; i < 100; ++i) {
    Step();
    ASSERT_LT(std::abs(peer.Tip().y() - start.y()), 1e-3) << i;
  }
}

struct TrackingByTheTipAlone : Running {
  TrackingByTheTipAlone() : Running(Text()) {}
  static std::string Text() {
    std::string text = SessionText() + "supervisor: {fault_after_s: 0.3}\n";
    const std::string kind = "rod-track";
    return text.replace(text.find(kind), kind.size(), "flex-track");
  }
};

TEST_F(TrackingByTheTipAlone, AFaultPausesTheRobotUntilAPersonEnablesIt) {
  RunUntilMoving();
  peer.tip_offset_m = 0.03;
  for (int i = 0; i < 5; ++i) Step();
  EXPECT_EQ(last.hold, Hold::kTipDisagrees);
  const Eigen::Vector3d held = peer.Wrist();
  for (int i = 0; i < 60; ++i) Step();
  EXPECT_EQ(peer.state.state, CrtkState::kPaused);
  EXPECT_EQ(peer.Wrist(), held);
  // The cause goes: nothing moves before somebody says so.
  peer.tip_offset_m = 0.0;
  for (int i = 0; i < 60; ++i) EXPECT_NE(Step().hold, Hold::kNone);
  peer.state.state = CrtkState::kEnabled;
  for (int i = 0; i < 60; ++i) Step();
  EXPECT_EQ(last.hold, Hold::kNone);
}

TEST_F(Running, APauseByAPersonStays) {
  RunUntilMoving();
  peer.state.state = CrtkState::kPaused;
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(Step().state_command);
    EXPECT_EQ(last.hold, Hold::kNotEnabled);
  }
}

TEST_F(Running, KeepsItsRateLimits) {
  RunUntilMoving();
  Eigen::Vector3d p = last.p_RW_command, v = Eigen::Vector3d::Zero();
  bool first = true;
  for (int i = 0; i < 60; ++i) {
    Step();
    ASSERT_EQ(last.hold, Hold::kNone);
    const Eigen::Vector3d v_now = (last.p_RW_command - p) / 0.01;
    EXPECT_LE(v_now.norm(), 0.05 * (1 + 1e-9));
    if (!first) {
      EXPECT_LE((v_now - v).norm(), 0.01 * (1 + 1e-6));
    }
    first = false;
    p = last.p_RW_command;
    v = v_now;
  }
}

std::string WithJerk() {
  std::string text = SessionText();
  const std::string limit = "max_acceleration_m_s2: 1.0";
  return text.replace(text.find(limit), limit.size(), limit + ", max_jerk_m_s3: 20");
}

struct RunningSmoothly : Running {
  RunningSmoothly() : Running(WithJerk()) {}
};

TEST_F(RunningSmoothly, KeepsItsLimitOfJerk) {
  RunUntilMoving();
  std::vector<Eigen::Vector3d> p{last.p_RW_command};
  for (int i = 0; i < 100; ++i) {
    Step();
    ASSERT_EQ(last.hold, Hold::kNone);
    p.push_back(last.p_RW_command);
  }
  double largest_m_s3 = 0.0;
  for (std::size_t i = 3; i < p.size(); ++i) {
    const Eigen::Vector3d third = p[i] - 3.0 * p[i - 1] + 3.0 * p[i - 2] - p[i - 3];
    largest_m_s3 = std::max(largest_m_s3, third.norm() / 1e-6);  // cycles of 10 ms
  }
  EXPECT_LE(largest_m_s3, 20.0 * (1 + 1e-6));
  EXPECT_GT(largest_m_s3, 1.0);
  EXPECT_GT((p.back() - p.front()).norm(), 0.001);
}

TEST_F(Running, TimeThatStandsIsAHold) {
  RunUntilMoving();
  CycleInputs inputs = peer.Next();
  cycle.Step(inputs);
  EXPECT_EQ(cycle.Step(inputs).hold, Hold::kBadTime);
}

TEST_F(Running, AllocatesNothingOnceItMoves) {
  RunUntilMoving();
  std::vector<CycleInputs> inputs;
  for (int i = 0; i < 20; ++i) inputs.push_back(peer.Next());
  for (int i = 0; i < 5; ++i) cycle.Step(inputs[i]);
  const long before = AllocationCount();
  for (int i = 5; i < 20; ++i) cycle.Step(inputs[i]);
  EXPECT_EQ(AllocationCount(), before);
}

struct Watching : Running {
  Watching() : Running(SessionText() + "diagnosis: {running: true}\n") {}
};

TEST_F(Watching, WarnsOfACauseInTheRecordingAndInTheReplay) {
  const auto folder = session.file.parent_path() / "watched";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  Recorder recorder(folder, session);
  int first = 0;
  constexpr int kCycles = 2400, kOnset = 800;
  for (int i = 0; i < kCycles; ++i) {
    if (i == kOnset) peer.tip_offset_m = 0.0015;
    CycleRecord record;
    record.inputs = peer.Next();
    record.outputs = last = cycle.Step(record.inputs);
    if (i % 100 == 0) {
      recorder.Take(StreamName::kWrist,
                    {record.inputs.t_ns, record.inputs.t_ns, record.inputs.streams.wrist->value});
    }
    recorder.Take(record);
    peer.Do(last);
    if (first == 0 && last.cause.IsThere()) first = i;
  }
  recorder.Finish();
  EXPECT_GT(first, kOnset);
  EXPECT_LT(first, kOnset + 800);
  const std::string events = ReadTextFile(folder / "session0/events.csv");
  EXPECT_THAT(events, testing::HasSubstr("warning: the "));
  const ReplayedSession replayed = ReplaySession(folder, RecordedSession(folder));
  EXPECT_EQ(replayed.equal, kCycles);
  // Without the watch the commands are the same, and the warnings are not.
  Session blind = RecordedSession(folder);
  blind.task.watch.running = false;
  const ReplayedSession unwatched = ReplaySession(folder, blind);
  EXPECT_EQ(unwatched.largest_difference_m, 0.0);
  EXPECT_EQ(unwatched.equal, first);
}

TEST_F(Running, ItsRecordingReplaysBitForBit) {
  const auto folder = session.file.parent_path() / "recording";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  Recorder recorder(folder, session);
  for (int i = 0; i < 150; ++i) {
    CycleRecord record;
    record.inputs = peer.Next();
    record.outputs = last = cycle.Step(record.inputs);
    recorder.Take(StreamName::kWrist,
                  {record.inputs.t_ns, record.inputs.t_ns, record.inputs.streams.wrist->value});
    recorder.Take(record);
    peer.Do(last);
  }
  recorder.Finish();
  const ReplayedSession replayed = ReplaySession(folder, RecordedSession(folder));
  EXPECT_EQ(replayed.cycles.size(), 150u);
  EXPECT_EQ(replayed.equal, 150);
  Session other = session;
  other.task.controller.gain = 0.5;
  const ReplayedSession slower = ReplaySession(folder, other);
  EXPECT_LT(slower.equal, 150);
  EXPECT_GT(slower.largest_difference_m, 1e-6);
  const ReadResult read = ReadRecording(folder);
  EXPECT_EQ(read.recording.wrist0->samples.size(), 150u);
  EXPECT_NEAR(read.recording.wrist0->rate_hz, 100.0, 1e-6);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
}

}  // namespace
}  // namespace flextip::live
