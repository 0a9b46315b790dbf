// Faults of the robot by themselves.
#include "simulation/faults/robot_faults.h"

#include <gtest/gtest.h>

namespace flextip::simulation {
namespace {

TEST(RobotFaults, AWristStandsOrSlowsDownForItsTime) {
  const RobotFaults stands({{FaultKind::kWristStands, FaultStream::kRobot, 1.0, 0.5, 0.0}}, 1);
  const RobotFaults slow({{FaultKind::kRobotRate, FaultStream::kRobot, 1.0, 0.5, 0.1}}, 1);
  for (const double t_s : {0.99, 1.5}) {
    EXPECT_EQ(stands.SpeedPart(t_s), 1.0);
    EXPECT_EQ(slow.SpeedPart(t_s), 1.0);
  }
  EXPECT_EQ(stands.SpeedPart(1.2), 0.0);
  EXPECT_EQ(slow.SpeedPart(1.2), 0.1);
}

TEST(RobotFaults, LosesItsPartOfTheCommands) {
  RobotFaults faults({{FaultKind::kCommandsLost, FaultStream::kRobot, 1.0, 1.0, 0.3}}, 1);
  int lost = 0;
  for (int i = 0; i < 1000; ++i) lost += faults.LosesCommand(1.0 + 1e-3 * i);
  EXPECT_NEAR(lost, 300, 60);
  EXPECT_FALSE(faults.LosesCommand(0.5));
}

TEST(RobotFaults, OneCycleIsLate) {
  RobotFaults faults({{FaultKind::kCycleLate, FaultStream::kRobot, 1.0, 0.5, 0.05}}, 1);
  EXPECT_EQ(faults.LateBy(0.9), 0.0);
  EXPECT_EQ(faults.LateBy(1.01), 0.05);
  EXPECT_EQ(faults.LateBy(1.04), 0.0);
}

TEST(RobotFaults, LeavesFaultsOfOthersAlone) {
  RobotFaults faults({{FaultKind::kStuck, FaultStream::kTip, 0.0, 9.0, 1.0}}, 1);
  EXPECT_EQ(faults.SpeedPart(1.0), 1.0);
  EXPECT_FALSE(faults.LosesCommand(1.0));
  EXPECT_EQ(faults.LateBy(1.0), 0.0);
}

}  // namespace
}  // namespace flextip::simulation
