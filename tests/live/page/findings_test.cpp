// What the page finds out beside a cycle, and the words that it has for each hold.
#include "live/page/findings.h"

#include <gmock/gmock.h>

#include "live/page/web_files.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

constexpr TimeNs kBegin_ns = 1'700'000'000'000'000'000, kCycle_ns = 10'000'000;

struct Found : testing::Test {
  Session session = ReadSession(WriteSession(SessionText()));
  PageFinder finder{session};
  PageSnapshot snapshot;

  /// Finds the cycle with this number; its goal is as many mm along x.
  const PageFindings& Find(int number) {
    snapshot.cycles = number;
    snapshot.record.inputs.t_ns = kBegin_ns + number * kCycle_ns;
    snapshot.record.outputs.p_RE_goal = Eigen::Vector3d(1e-3 * number, 0.0, 0.0);
    snapshot.accepted[0] = 3L * number;
    finder.Note(snapshot);
    return finder.Find(snapshot);
  }
  double GoalAt(TimeNs t_ns) const { return 1e3 * finder.At(t_ns).p_RE_goal->x(); }
};

TEST_F(Found, ALatePictureIsDrawnOverWithTheMomentNearestToIt) {
  for (int number = 1; number <= 50; ++number) Find(number);
  EXPECT_DOUBLE_EQ(GoalAt(kBegin_ns + 37 * kCycle_ns), 37.0);
  EXPECT_DOUBLE_EQ(GoalAt(kBegin_ns + 37 * kCycle_ns + kCycle_ns / 3), 37.0);
  EXPECT_DOUBLE_EQ(GoalAt(kBegin_ns + 37 * kCycle_ns + 2 * kCycle_ns / 3), 38.0);
  EXPECT_DOUBLE_EQ(GoalAt(kBegin_ns), 1.0);
  EXPECT_DOUBLE_EQ(GoalAt(kBegin_ns + 1'000 * kCycle_ns), 50.0);
}

TEST_F(Found, MomentsOfMoreThanASecondAgoAreForgotten) {
  Find(1);
  Find(150);
  EXPECT_DOUBLE_EQ(GoalAt(kBegin_ns + kCycle_ns), 150.0);
}

TEST_F(Found, RatesAreOfTheSessionsOwnTime) {
  for (int number = 1; number <= 200; ++number) Find(number);
  EXPECT_NEAR(Find(201).rates_hz[0], 300.0, 1e-9);  // three samples in 10 ms
  EXPECT_EQ(finder.Find(snapshot).rates_hz[1], 0.0);
}

TEST_F(Found, WithoutAWristThereIsNoShaftAndNoAngle) {
  EXPECT_TRUE(Find(1).now.shape.empty());
  EXPECT_FALSE(Find(2).worst);
}

TEST_F(Found, TheSameCycleIsNotNewTwice) {
  snapshot.cycles = 7;
  EXPECT_TRUE(finder.Note(snapshot));
  EXPECT_FALSE(finder.Note(snapshot));
}

TEST(Words, AreThereForEveryHold) {
  std::string words;
  for (const ServedFile& file : WebFiles())
    if (file.path == "/words.js") words = file.text;
  for (int i = 0; i < kHolds; ++i) {
    const std::string name = Name(static_cast<Hold>(i));
    EXPECT_THAT(words, testing::HasSubstr("\n  " + name + ": [\"")) << name;
  }
}

}  // namespace
}  // namespace flextip::live
