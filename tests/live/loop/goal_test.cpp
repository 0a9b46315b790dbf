// The tip goes where a peer wants it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "live/recorder/recorder.h"
#include "live/recorder/replay.h"
#include "tests/live/loop/peer.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;

std::string TextWithGoal() {
  std::string text = SessionText();
  text.erase(text.find("path:"));
  return text +
         "path: {goal: {openigtlink: {port: 18946, device: goal}}, average_s: 0.2, "
         "speed_m_s: 0.01}\n";
}

struct Goal : Running {
  Goal() : Running(TextWithGoal()) {}
};

TEST_F(Goal, TheTipStaysUntilOneIsThereAndThenGoesThere) {
  RunUntilMoving();
  const Eigen::Vector3d start = peer.Tip();
  for (int i = 0; i < 50; ++i) Step();
  EXPECT_LT((peer.Tip() - start).norm(), 5e-4);
  const Eigen::Vector3d wanted = start + Eigen::Vector3d(0, 0.004, -0.006);
  peer.Want(wanted);
  for (int i = 0; i < 40; ++i) Step();
  EXPECT_NEAR((peer.Tip() - start).norm(), 0.4 * 0.01, 1e-3);  // at the session's speed
  for (int i = 0; i < 50; ++i) Step();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // the seen tip is noisy in depth
  for (int i = 0; i < 50; ++i) {
    Step();
    sum += peer.Tip();
  }
  EXPECT_LT((sum / 50 - wanted).norm(), 4e-4);
  EXPECT_FALSE(last.done);
}

TEST_F(Goal, APeerThatIsGoneHoldsTheRobot) {
  RunUntilMoving();
  peer.Lose(kGoalPeer);
  Step();
  EXPECT_EQ(last.hold, Hold::kSourceLost);
  EXPECT_EQ(last.held_by, kGoalPeer);
}

TEST_F(Goal, OldAndBrokenOnesAreRefusedWithTheirValues) {
  RunUntilMoving();
  EXPECT_EQ(peer.Want(peer.Tip()), "");
  EXPECT_THAT(peer.Want(peer.Tip()), HasSubstr("expected a later one"));  // of the same time
  Step();
  EXPECT_THAT(peer.Want(Eigen::Vector3d::Constant(std::nan(""))), HasSubstr("found a goal nan m"));
  EXPECT_THAT(peer.Want({250.0, 0.0, 0.0}), HasSubstr("found a goal 250 m from R"));
  Step();
  ASSERT_TRUE(last.p_RE_goal);
  EXPECT_LT((*last.p_RE_goal - peer.Tip()).norm(), 2e-3);
}

TEST_F(Goal, ReplaysBitForBit) {
  const auto folder = session.file.parent_path() / "goal_recording";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  Recorder recorder(folder, session);
  for (int i = 0; i < 150; ++i) {
    if (i == 100) peer.Want(peer.Tip() + Eigen::Vector3d(0, 0, -0.01));
    CycleRecord record;
    record.inputs = peer.Next();
    record.outputs = last = cycle.Step(record.inputs);
    recorder.Take(record);
    peer.Do(last);
  }
  recorder.Finish();
  const ReplayedSession replayed = ReplaySession(folder, RecordedSession(folder));
  EXPECT_EQ(replayed.equal, 150);
  EXPECT_EQ(last.hold, Hold::kNone);
}

/// Returns the text without the last `count` columns of each row.
std::string WithoutLast(const std::string& text, int count) {
  std::istringstream rows(text);
  std::string shorter;
  for (std::string row; std::getline(rows, row);) {
    for (int i = 0; i < count; ++i) row.erase(row.rfind(','));
    shorter += row + "\n";
  }
  return shorter;
}

TEST_F(Running, ARecordingOfATimeBeforeGoalsReplays) {
  const auto folder = session.file.parent_path() / "older_recording";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  Recorder recorder(folder, session);
  for (int i = 0; i < 80; ++i) {
    CycleRecord record;
    record.inputs = peer.Next();
    record.outputs = last = cycle.Step(record.inputs);
    recorder.Take(record);
    peer.Do(last);
  }
  recorder.Finish();
  const auto file = folder / "session0" / "cycles.csv";
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::ofstream(file) << WithoutLast(text.str(), 21);
  const ReplayedSession replayed = ReplaySession(folder, RecordedSession(folder));
  EXPECT_EQ(replayed.equal, 80);
}

}  // namespace
}  // namespace flextip::live
