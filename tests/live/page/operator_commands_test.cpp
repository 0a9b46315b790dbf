// A person's wishes at the page become commands for the robot.
#include "live/page/operator_commands.h"

#include <gtest/gtest.h>

namespace flextip::live {
namespace {

constexpr TimeNs kCycle_ns = 10'000'000;

struct AtAPage : testing::Test {
  OperatorCommands operators;
  CrtkOperatingState robot;
  TimeNs t_ns = 1'700'000'000'000'000'000;

  std::optional<CrtkCommand> Next(std::optional<CrtkCommand> own = {}) {
    t_ns += kCycle_ns;
    return operators.Next(t_ns, Arrived<CrtkOperatingState>{t_ns, t_ns, robot}, own);
  }
};

TEST_F(AtAPage, WithoutAWishTheCycleCommands) {
  EXPECT_FALSE(Next());
  EXPECT_EQ(Next(CrtkCommand::kHome), CrtkCommand::kHome);
}

TEST_F(AtAPage, APauseIsSaidAgainUntilTheRobotHasDoneIt) {
  robot = {CrtkState::kEnabled, true, false};
  operators.Pause();
  EXPECT_EQ(Next(), CrtkCommand::kPause);
  int again = 0;
  for (int i = 0; i < 100; ++i) again += Next().has_value();
  EXPECT_EQ(again, 5);  // five times in a second
  robot.state = CrtkState::kPaused;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(Next());
}

TEST_F(AtAPage, ARobotThatDoesNotSayItsStateIsToldToPauseForASecond) {
  operators.Pause();
  int told = 0;
  for (int i = 0; i < 300; ++i) {
    t_ns += kCycle_ns;
    told += operators.Next(t_ns, {}, {}) == CrtkCommand::kPause;
  }
  EXPECT_EQ(told, 5);
}

TEST_F(AtAPage, ThePausedRobotIsNotEnabledByTheCycle) {
  robot = {CrtkState::kPaused, true, false};
  operators.Pause();
  EXPECT_FALSE(Next(CrtkCommand::kResume));
  EXPECT_FALSE(Next(CrtkCommand::kEnable));
  EXPECT_EQ(Next(CrtkCommand::kPause), CrtkCommand::kPause);  // its own end
  robot.state = CrtkState::kEnabled;                          // somebody else did
  EXPECT_EQ(Next(), CrtkCommand::kPause);
}

TEST_F(AtAPage, EnablingGoesStepByStepAndThenTheCycleCommandsAgain) {
  operators.Enable();
  EXPECT_EQ(Next(), CrtkCommand::kEnable);
  EXPECT_FALSE(Next(CrtkCommand::kHome));  // one command at a time
  robot.state = CrtkState::kEnabled;
  t_ns += 20 * kCycle_ns;
  EXPECT_EQ(Next(), CrtkCommand::kHome);
  robot.is_busy = true;
  t_ns += 50 * kCycle_ns;
  EXPECT_FALSE(Next());
  robot = {CrtkState::kEnabled, true, false};
  EXPECT_FALSE(Next());
  robot.state = CrtkState::kPaused;  // by somebody else, later
  t_ns += 50 * kCycle_ns;
  EXPECT_FALSE(Next());
  operators.Enable();
  EXPECT_EQ(Next(), CrtkCommand::kResume);
}

TEST_F(AtAPage, NobodyEnablesARobotInFault) {
  robot.state = CrtkState::kFault;
  operators.Enable();
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(Next());
  robot.state = CrtkState::kDisabled;  // the wish is gone
  EXPECT_FALSE(Next());
}

TEST_F(AtAPage, EnablingThatLeadsNowhereEnds) {
  operators.Enable();
  for (int i = 0; i < 1100; ++i) Next();
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(Next());
}

TEST_F(AtAPage, APauseComesBeforeAnEarlierEnable) {
  robot = {CrtkState::kEnabled, false, false};
  operators.Enable();
  EXPECT_EQ(Next(), CrtkCommand::kHome);
  operators.Pause();
  EXPECT_EQ(Next(), CrtkCommand::kPause);
}

}  // namespace
}  // namespace flextip::live
