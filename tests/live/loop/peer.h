// A plant, its sensors and a robot for the cycle, without sockets.
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "live/loop/cycle.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/sensors.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {

inline constexpr TimeNs kPeriod_ns = 10'000'000;

/// Plant, sensors and a robot of few words, stepped by hand. No sockets.
class Peer {
 public:
  explicit Peer(const Session& session)
      : plant_(SetupOf(session), {30, 30}), sensors_(SensorsOf(session), 7), streams_(session) {
    for (int i = 0; i <= kGoalPeer; ++i) streams_.SetThere(i, true);
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
      for (int i = 0; i < 3; ++i) v.push_back(1e3 * (tip.p_RE[i] + (i == 1 ? tip_offset_m : 0.0)));
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
  /// A stream, or kGoalPeer.
  void Lose(int stream) { streams_.SetThere(stream, false); }
  /// Returns why the goal is refused; empty where it is taken.
  std::string Want(const Eigen::Vector3d& p_RE) {
    WireTransform goal;
    goal.T_RD.p = p_RE;
    return streams_.TakeGoal({"", t_ns_, goal}, t_ns_);
  }

  CrtkOperatingState state;
  bool wrist_there = true, tip_there = true, strain_there = true;
  TimeNs tip_clock_ns = 0;    // how far the tip's clock is ahead
  double tip_offset_m = 0.0;  // of what is seen of the tip, along y

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
inline std::pair<CycleOutputs, bool> AfterOneSecond(const Session& session,
                                                    TimeNs tip_clock_ns = 0) {
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

struct Running : testing::Test {
  explicit Running(const std::string& text = SessionText())
      : session(ReadSession(WriteSession(text))) {}

  Session session;
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

}  // namespace flextip::live
