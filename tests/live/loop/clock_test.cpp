// Clocks that align found, in a session.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/loop/peer.h"

namespace flextip::live {
namespace {

/// Writes a clock of the tip's camera, as align finds it, beside a session that takes it.
Session WithClock(double offset_s, double rate, double sd_s, double rate_sd) {
  Calibration clocks;
  clocks.kind = "clocks";
  clocks.numbers["cam0.time_offset_s"] = {offset_s};
  clocks.numbers["cam0.time_origin_s"] = {1e-9 * simulation::kSimulationStart_ns};
  clocks.numbers["cam0.time_rate"] = {rate};
  clocks.covariance = Eigen::Vector3d(sd_s * sd_s, 0.0, rate_sd * rate_sd).asDiagonal();
  const auto file = WriteSession(SessionText() + "calibrations: [clocks.yaml]\n");
  WriteCalibration(file.parent_path() / "clocks.yaml", clocks);
  return ReadSession(file);
}

TEST(Clock, ThatAlignFoundIsTakenOff) {
  const TimeNs ahead_ns = 2'500'000'000;
  const Session without = ReadSession(WriteSession(SessionText()));
  EXPECT_EQ(AfterOneSecond(without, ahead_ns).first.hold, Hold::kBadTime);
  const Session with = WithClock(-2.5, 0.0, 3e-4, 0.0);
  EXPECT_EQ(AfterOneSecond(with, ahead_ns).first.hold, Hold::kNone);
}

TEST(Clock, DeviationGrowsWithTheTimeSinceItWasFound) {
  const Session session = WithClock(-2.5, 1e-4, 3e-4, 5e-6);
  const TimeNs origin_ns = simulation::kSimulationStart_ns;
  EXPECT_NEAR(session.TimeSdOf(StreamName::kTip, origin_ns), 3e-4, 1e-12);
  EXPECT_NEAR(session.TimeSdOf(StreamName::kTip, origin_ns + 3'600'000'000'000),
              std::hypot(3e-4, 3600 * 5e-6), 1e-9);
  EXPECT_EQ(session.TimeSdOf(StreamName::kWrist, origin_ns), 0.0);
}

TEST(Clock, IsTheLatencyOfACameraOfThisMachine) {
  Session session = WithClock(-0.062, 0.0, 0.002, 0.0);
  session.streams[static_cast<std::size_t>(StreamName::kTip)].reset();
  CameraSetup& camera = session.camera.emplace();
  camera.video = "0";
  camera.clocks = {*ClockIn(session.calibrations[0].calibration, "cam0")};
  EXPECT_NEAR(session.LatencyOf(StreamName::kTip).value_s, 0.062, 1e-9);
  EXPECT_EQ(camera.TimeOf(1'000'000'000), 938'000'000);
  EXPECT_NEAR(session.TimeSdOf(StreamName::kTip, 0), 0.002, 1e-12);
}

}  // namespace
}  // namespace flextip::live
