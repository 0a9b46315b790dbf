// The cycle on a plant in process: it starts the robot, follows the path, holds, and replays.
#include "live/loop/cycle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>
#include <utility>

#include "live/recorder/recorder.h"
#include "live/recorder/replay.h"
#include "recording/recording_reader.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/sensors.h"
#include "tests/control/allocation_counter.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

constexpr TimeNs kPeriod_ns = 10'000'000;

/// Plant, sensors and a robot of few words, stepped by hand. No sockets.
class Peer {
 public:
  explicit Peer(const Session& session)
      : plant_(SetupOf(session), {30, 30}), sensors_(SensorsOf(session), 7), streams_(session) {
    for (int i = 0; i <= kStreams; ++i) streams_.SetThere(i, true);
    shape_ = plant_.Solve(p_RW_);
  }

  /// Lets the time go on by a cycle and gives its samples.
  CycleInputs Next() {
    t_ns_ += kPeriod_ns;
    shape_ = plant_.Solve(p_RW_);
    Recording r;
    sensors_.Sample(shape_, t_ns_, r);
    if (r.wrist0) {
      WireTransform wrist;
      const WristSample& sample = r.wrist0->samples.back().value;
      wrist.T_RD = Pose::FromQuaternion(*sample.q_RW, sample.p_RW);
      if (wrist_there) Give(StreamName::kWrist, wrist);
    }
    if (r.strain0) {
      const Eigen::Vector4d& m = r.strain0->moments_Nm.back().value;
      if (strain_there) Give(StreamName::kStrain, WireNumbers{{m[0], m[1], m[2], m[3]}});
    }
    if (r.vision0 && tip_there) {
      const TipObservation& tip = r.vision0->tips.back().value;
      std::vector<double> v;
      for (int i = 0; i < 3; ++i) v.push_back(1e3 * tip.p_RE[i]);
      for (int i = 0; i < 9; ++i) v.push_back(1e6 * tip.covariance_m2(i / 3, i % 3));
      for (int i = 0; i < 3; ++i) v.push_back((*tip.d_RE)[i]);
      v.push_back(0.003);
      streams_.Take(StreamName::kTip, {"", t_ns_ + tip_clock_ns, WireNumbers{v}}, t_ns_);
    }
    streams_.TakeState(Text(state), t_ns_, t_ns_);
    return {t_ns_, streams_.Look(), false};
  }

  void Do(const CycleOutputs& outputs) {
    if (outputs.state_command == CrtkCommand::kEnable) state.state = CrtkState::kEnabled;
    if (outputs.state_command == CrtkCommand::kHome) state.is_homed = true;
    if (outputs.state_command == CrtkCommand::kPause) state.state = CrtkState::kPaused;
    if (outputs.has_command && state.state == CrtkState::kEnabled) p_RW_ = outputs.p_RW_command;
  }

  Eigen::Vector3d Tip() const { return shape_.T_RE().p; }
  Eigen::Vector3d Wrist() const { return p_RW_; }
  void Lose(StreamName stream) { streams_.SetThere(static_cast<int>(stream), false); }

  CrtkOperatingState state;
  bool wrist_there = true, tip_there = true, strain_there = true;
  TimeNs tip_clock_ns = 0;  // how far the tip's clock is ahead

 private:
  static simulation::PlantSetup SetupOf(const Session& session) {
    simulation::PlantSetup setup;
    setup.instrument = session.base.instrument;
    setup.p_RP = session.base.p_RP;
    return setup;
  }
  static simulation::SensorSetup SensorsOf(const Session& session) {
    simulation::SensorSetup s;
    s.wrist = session.base.wrist0;
    s.wrist->rate_hz = 100.0;
    s.strain = session.base.strain0;
    s.strain->rate_hz = 100.0;
    s.tip.emplace();
    return s;
  }
  template <class Body>
  void Give(StreamName stream, const Body& body) {
    streams_.Take(stream, {"", t_ns_, body}, t_ns_);
  }

  simulation::Plant plant_;
  simulation::Sensors sensors_;
  Streams streams_;
  simulation::PlantShape shape_;
  Eigen::Vector3d p_RW_{-0.2457, 0.0, 0.3421};
  TimeNs t_ns_ = simulation::kSimulationStart_ns;
};

/// Returns the session's cycle after 100 steps, and whether the robot was told anything.
std::pair<CycleOutputs, bool> AfterOneSecond(const Session& session, TimeNs tip_clock_ns = 0) {
  Peer peer(session);
  peer.tip_clock_ns = tip_clock_ns;
  Cycle cycle(session);
  CycleOutputs last;
  bool told = false;
  for (int i = 0; i < 100; ++i) {
    last = cycle.Step(peer.Next());
    peer.Do(last);
    told |= last.state_command.has_value();
  }
  return {last, told};
}

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

struct Running : testing::Test {
  Session session = ReadSession(WriteSession(SessionText()));
  Peer peer{session};
  Cycle cycle{session};
  CycleOutputs last;

  CycleOutputs Step() {
    last = cycle.Step(peer.Next());
    peer.Do(last);
    return last;
  }
  void RunUntilMoving() {
    for (int i = 0; i < 200 && Step().hold != Hold::kNone; ++i) {
    }
    ASSERT_EQ(last.hold, Hold::kNone);
  }
};

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
  peer.Lose(StreamName::kStrain);
  Step();
  EXPECT_EQ(last.hold, Hold::kSourceLost);
  EXPECT_STREQ(Name(static_cast<StreamName>(last.held_by)), "strain0");
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
