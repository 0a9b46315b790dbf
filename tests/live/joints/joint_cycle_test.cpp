// The cycle at an arm's joints against a robot of few words that lags, is late and reads its joints
// wrongly, and what makes it stop.
#include "live/joints/joint_cycle.h"

#include <gmock/gmock.h>

#include <cmath>
#include <deque>
#include <fstream>

#include "core/error.h"
#include "live/joints/joint_table.h"
#include "tests/control/allocation_counter.h"

namespace flextip::live {
namespace {

constexpr TimeNs kStep_ns = 2'000'000, kStart_ns = 1'700'000'000'000'000'000;
constexpr double kStep_s = 2e-3, kLag_s = 0.04, kOffset = 0.02, kPath_s = 3.0;
constexpr int kLate = 10;  // steps

JointVector V(double a, double b) {
  JointVector v(2);
  v << a, b;
  return v;
}

/// From rest, of path time.
JointWish PathAt(double t) {
  const double u = std::clamp(t, 0.0, kPath_s);
  const double inside = t == u ? 1.0 : 0.0, w = 2.0 * std::numbers::pi / kPath_s;
  return {V(0.3 + 0.2 * (1.0 - std::cos(w * u)), 0.1 * (1.0 - std::cos(w * u))),
          inside * w * std::sin(w * u) * V(0.2, 0.1),
          inside * w * w * std::cos(w * u) * V(0.2, 0.1),
          {}};
}

JointWay Way() {
  JointWay way;
  way.wish = [](double t_s, const JointFeedForward& f) { return PathAt(t_s + f.Lead_s()); };
  way.seconds = kPath_s;
  return way;
}

JointModel Model(bool known) {
  JointModel model(2);
  if (!known) return model;
  model.delay_s = kLate * kStep_s;
  model.lag_s = V(kLag_s, kLag_s);
  model.offset = V(kOffset, 0.0);
  return model;
}

JointCycleOptions Options() {
  JointCycleOptions options;
  options.follow_limit = V(0.2, 0.2);
  options.approach_rate = V(0.2, 0.2);
  return options;
}

class Robot {
 public:
  JointInputs Inputs() {
    t_ns_ += kStep_ns;
    if (!silent) measured_ns_ = t_ns_;
    JointInputs inputs;
    inputs.t_ns = t_ns_;
    inputs.measured_ns = measured_ns_;
    inputs.q = encoder_ + jump;
    inputs.state = state;
    return inputs;
  }
  void Do(const JointOutputs& outputs) {
    if (outputs.state_command == CrtkCommand::kEnable) state.state = CrtkState::kEnabled;
    if (outputs.state_command == CrtkCommand::kHome) state.is_homed = true;
    if (outputs.state_command == CrtkCommand::kPause) state.state = CrtkState::kPaused;
    if (outputs.has_command && state.state == CrtkState::kEnabled) commands_.push_back(outputs.q);
    if (int(commands_.size()) <= kLate) return;
    const JointVector& late = commands_[commands_.size() - 1 - kLate];
    encoder_ += (1.0 - std::exp(-kStep_s / kLag_s)) * (late - encoder_);
  }
  JointVector Truth() const { return encoder_ + V(kOffset, 0.0); }

  CrtkOperatingState state;
  bool silent = false;
  JointVector jump = V(0.0, 0.0);

 private:
  TimeNs t_ns_ = kStart_ns, measured_ns_ = 0;
  JointVector encoder_ = V(0.0, 0.0);
  std::vector<JointVector> commands_;
};

struct Gone {
  std::deque<JointRecord> cycles;
  double worst = 0.0;  ///< true joints less desired ones, on the path
};

/// Runs until it is over, 20 s at most; `disturb` is called before each cycle.
Gone RunCycle(
    bool known, const std::function<void(Robot&, JointInputs&, const JointOutputs&)>& disturb =
                    [](Robot&, JointInputs&, const JointOutputs&) {}) {
  JointCycle cycle(Model(known), Way(), Options());
  Robot robot;
  Gone run;
  JointOutputs last;
  for (int k = 0; k < 10'000; ++k) {
    JointInputs inputs = robot.Inputs();
    disturb(robot, inputs, last);
    if (last.path_s > 0.0) {
      const JointVector off = robot.Truth() - PathAt(last.path_s).q;
      run.worst = std::max(run.worst, off.cwiseAbs().maxCoeff());
    }
    last = cycle.Step(inputs);
    run.cycles.push_back({inputs, last, last.has_command});
    robot.Do(last);
    if (last.over && robot.state.state != CrtkState::kEnabled) break;
  }
  return run;
}

TEST(JointCycle, BringsTheTrueJointsAlongThePath) {
  const Gone plain = RunCycle(false), known = RunCycle(true);
  EXPECT_EQ(known.cycles.back().outputs.hold, JointHold::kDone);
  EXPECT_GT(plain.worst, 0.03);
  EXPECT_LT(known.worst, 0.0025);
}

TEST(JointCycle, HomesFirstAndApproachesSlowly) {
  const Gone run = RunCycle(true);
  JointVector last;
  bool enabled = false;
  double fastest = 0.0;
  for (const JointRecord& record : run.cycles) {
    const bool ready =
        record.inputs.state->state == CrtkState::kEnabled && record.inputs.state->is_homed;
    enabled = enabled || ready;
    if (!enabled) EXPECT_FALSE(record.outputs.has_command);
    if (record.outputs.hold != JointHold::kApproaching) continue;
    if (last.size() > 0)
      fastest = std::max(fastest, (record.outputs.q - last).cwiseAbs().maxCoeff() / kStep_s);
    last = record.outputs.q;
  }
  EXPECT_LT(fastest, 0.2001);
  EXPECT_GT(fastest, 0.15);
}

/// What ended a run that is disturbed half a second into its path.
JointHold EndBy(const std::function<void(Robot&, JointInputs&)>& disturb) {
  const Gone run = RunCycle(true, [&](Robot& robot, JointInputs& inputs, const JointOutputs& last) {
    if (last.path_s > 0.5 || last.over) disturb(robot, inputs);
  });
  const JointRecord& end = run.cycles.back();
  bool paused = false, over = false;
  for (const JointRecord& record : run.cycles) {
    paused = paused || record.outputs.state_command == CrtkCommand::kPause;
    over = over || record.outputs.over;
    if (over) EXPECT_FALSE(record.outputs.has_command);  // for good
  }
  if (end.outputs.hold != JointHold::kNotEnabled) EXPECT_TRUE(paused);
  return end.outputs.hold;
}

TEST(JointCycle, PausesWhereSomethingIsWrong) {
  using R = Robot;
  using I = JointInputs;
  EXPECT_EQ(EndBy([](R& robot, I&) { robot.silent = true; }), JointHold::kStaleJoints);
  EXPECT_EQ(EndBy([](R&, I& inputs) { inputs.lost = true; }), JointHold::kStaleJoints);
  EXPECT_EQ(EndBy([](R& robot, I&) { robot.jump = V(0.3, 0.0); }), JointHold::kNotFollowing);
  EXPECT_EQ(EndBy([](R&, I& inputs) { inputs.q[0] = std::nan(""); }), JointHold::kNoJoints);
  EXPECT_EQ(EndBy([](R&, I& inputs) { inputs.stop = true; }), JointHold::kStopped);
  EXPECT_EQ(EndBy([](R& robot, I& inputs) {
              robot.state.state = CrtkState::kFault;
              inputs.state = robot.state;
            }),
            JointHold::kNotEnabled);
}

TEST(JointCycle, TimeThatStandsCommandsNothing) {
  JointCycle cycle(Model(true), Way(), Options());
  Robot robot;
  JointInputs inputs = robot.Inputs();
  cycle.Step(inputs);
  const JointOutputs outputs = cycle.Step(inputs);
  EXPECT_EQ(outputs.hold, JointHold::kBadTime);
  EXPECT_FALSE(outputs.has_command);
}

TEST(JointCycle, RunsAgainFromItsTableBitForBit) {
  Gone run = RunCycle(true);
  run.cycles[5].inputs.effort = V(0.1, -2.0 / 3.0);
  const std::string file = testing::TempDir() + "joint_cycles.csv";
  std::ofstream(file) << JointCyclesCsv(run.cycles, 2);
  ReadLog log;
  std::deque<JointRecord> read = ReadJointCycles(file, 2, log);
  ASSERT_EQ(read.size(), run.cycles.size());
  EXPECT_EQ(read[5].inputs.effort, run.cycles[5].inputs.effort);
  EXPECT_EQ(CyclesThatDiffer(read, JointCycle(Model(true), Way(), Options())), 0);
  EXPECT_GT(CyclesThatDiffer(read, JointCycle(Model(false), Way(), Options())), 1000);
  read[2000].outputs.q[0] = std::nextafter(read[2000].outputs.q[0], 1.0);
  EXPECT_EQ(CyclesThatDiffer(read, JointCycle(Model(true), Way(), Options())), 1);
}

TEST(JointCycle, AStepAllocatesNothing) {
  if (!CountsAllocations()) GTEST_SKIP() << "allocations are not counted";
  const Gone run = RunCycle(true);
  JointCycle cycle(Model(true), Way(), Options());
  const long before = AllocationCount();
  for (const JointRecord& record : run.cycles) cycle.Step(record.inputs);
  EXPECT_EQ(AllocationCount(), before);
}

TEST(JointCycle, RefusesLimitsOfAnotherArm) {
  JointCycleOptions options = Options();
  options.follow_limit = JointVector::Ones(3);
  EXPECT_THROW(JointCycle(Model(true), Way(), options), InputError);
}

}  // namespace
}  // namespace flextip::live
