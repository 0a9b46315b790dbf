// Which stops a run has, and what is said of them.
#include "stops/stop_finder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stops/words.h"

namespace flextip {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr TimeNs kSecond_ns = 1'000'000'000;

/// Cycles at 10 Hz: 'g' goes on, 'h' is held, 'F' is a fault, 's' is held before the motion began.
std::vector<StopEvent> StopsOf(const std::string& cycles) {
  StopFinder finder;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const char c = cycles[i];
    finder.Add({static_cast<TimeNs>(i + 1) * kSecond_ns / 10, c == 'g' ? "" : "tip_jump", c == 'F',
                c != 's'});
  }
  return finder.Stops();
}

TEST(StopFinder, FindsNoneWhereNothingHolds) { EXPECT_TRUE(StopsOf("gggggg").empty()); }

TEST(StopFinder, AHoldBeforeTheMotionIsNone) { EXPECT_TRUE(StopsOf("ssssgggg").empty()); }

TEST(StopFinder, AHoldThatBecomesAFaultIsOneStop) {
  const auto stops = StopsOf("ggghhhFFFF");
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_EQ(stops[0].begin_ns, 4 * kSecond_ns / 10);
  EXPECT_EQ(stops[0].fault_ns, 7 * kSecond_ns / 10);
  EXPECT_EQ(stops[0].end_ns, kSecond_ns);
  EXPECT_TRUE(stops[0].open);
}

TEST(StopFinder, HoldsNearEachOtherAreOneRun) {
  const auto stops = StopsOf("ghhgghhhggg");
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_EQ(stops[0].holds, 2);
  EXPECT_FALSE(stops[0].open);
  EXPECT_EQ(StopsOf("gh" + std::string(120, 'g') + "hg").size(), 2U);
}

TEST(StopFinder, AFaultAfterAnotherIsAStopOfItsOwn) {
  const auto stops = StopsOf("ghFFgggghhFFF");
  ASSERT_EQ(stops.size(), 2U);
  EXPECT_EQ(stops[0].fault_ns, 3 * kSecond_ns / 10);
  EXPECT_EQ(stops[1].fault_ns, 11 * kSecond_ns / 10);
}

TEST(StopFinder, TheFaultOfARunIsItsStop) {
  const auto stops = StopsOf("ghgghhF");
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_EQ(stops[0].begin_ns, 5 * kSecond_ns / 10);
}

TEST(StopFinder, FaultsWeighMost) {
  const auto stops = Gravest(StopsOf("ghhhhhhgg" + std::string(120, 'g') + "hFg"), 1);
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_TRUE(stops[0].IsFault());
}

StopFacts CameraAway() {
  StopFacts facts;
  facts.cause = "tip_disagrees";
  facts.at_s = 3.42;
  facts.fault_s = 5.42;
  facts.odd = VotedSensor::kTip;
  facts.odd_is_named = true;
  facts.odd_distance_m = 0.0081;
  facts.others = {VotedSensor::kEm, VotedSensor::kStrain, VotedSensor::kWristTurn};
  return facts;
}

TEST(StopWords, SayWhichSensorWasWhereTheOthersWereNot) {
  EXPECT_EQ(SayStop(CameraAway()),
            "Held at 3.42 s by tip_disagrees: the camera's tip was 8.1 mm from where EM, strain "
            "and wrist put it; the robot was paused at 5.42 s.");
}

TEST(StopWords, DoNotBlameASensorThatWasNotNamed) {
  StopFacts facts = CameraAway();
  facts.odd_is_named = false;
  EXPECT_THAT(SayStop(facts), HasSubstr("which sensor was wrong could not be told"));
  facts.odd.reset();
  facts.chi2 = 90.0;
  facts.chi2_limit = 30.0;
  EXPECT_THAT(SayStop(facts), HasSubstr("3 times its limit"));
}

TEST(StopWords, SayHowItEnded) {
  StopFacts facts = CameraAway();
  facts.fault_s.reset();
  facts.end_s = 4.0;
  EXPECT_THAT(SayStop(facts), HasSubstr("it went on by itself after 0.58 s."));
  facts.open = true;
  EXPECT_THAT(SayStop(facts), HasSubstr("still held when the recording ended"));
  EXPECT_THAT(SayStop(facts), Not(HasSubstr("paused")));
}

}  // namespace
}  // namespace flextip
