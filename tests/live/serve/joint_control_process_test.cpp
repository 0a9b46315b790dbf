// flextip control at the joints of a robot over ROS 2: the robot is here, the program a process of
// its own.
#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>

#include "core/robot/crtk.h"
#include "live/dds/node.h"
#include "live/streams/streams.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "tests/apps/run_program.h"
#include "tests/live/dds/domain_of_tests.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;

constexpr double kLag_s = 0.05, kOffset = 0.02;

/// Two joints behind a lag; the first one's encoder is off. 500 states a second.
class Robot {
 public:
  Robot()
      : node_(
            Setup(), [this](WireMessage&& m) { Take(m); }, [](WireEvent&&) {}),
        thread_([this] { Run(); }) {}
  ~Robot() {
    ends_ = true;
    thread_.join();
  }
  /// Where the joints truly were, and when.
  std::vector<std::pair<TimeNs, Eigen::Vector2d>> Truth() {
    const std::lock_guard lock(mutex_);
    return truth_;
  }

 private:
  static Ros2Setup Setup() {
    Ros2Setup setup;
    setup.domain = DomainOfTests();
    setup.in = {{"PSM1/servo_jp", Ros2TypesFor(Content::kJoints)},
                {"PSM1/state_command", Ros2TypesFor(Content::kText)}};
    setup.out = {{"PSM1/measured_js", Ros2TypesFor(Content::kJoints)},
                 {"PSM1/operating_state", Ros2TypesFor(Content::kState)}};
    return setup;
  }

  void Take(const WireMessage& message) {
    const std::lock_guard lock(mutex_);
    if (const auto* text = std::get_if<WireText>(&message.body)) {
      const auto command = CrtkCommandOf(text->text);
      if (command == CrtkCommand::kEnable || command == CrtkCommand::kResume)
        state_.state = CrtkState::kEnabled;
      if (command == CrtkCommand::kHome) state_.is_homed = true;
      if (command == CrtkCommand::kPause) state_.state = CrtkState::kPaused;
    } else if (const auto* joints = std::get_if<WireNumbers>(&message.body)) {
      if (state_.state != CrtkState::kEnabled || joints->values.size() != 2) return;
      command_ = {joints->values[0], joints->values[1]};
    }
  }

  void Run() {
    TimeNs last_ns = Now_ns();
    while (!ends_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const TimeNs now_ns = Now_ns();
      const double dt_s = 1e-9 * double(now_ns - last_ns);
      last_ns = now_ns;
      WireMessage joints, state;
      {
        const std::lock_guard lock(mutex_);
        encoder_ += (1.0 - std::exp(-dt_s / kLag_s)) * (command_ - encoder_);
        truth_.emplace_back(now_ns, encoder_ + Eigen::Vector2d(kOffset, 0.0));
        joints = {"PSM1/measured_js", now_ns, WireNumbers{{encoder_[0], encoder_[1]}}};
        state = {"PSM1/operating_state", now_ns, WireText{Text(state_)}};
      }
      node_.Send(joints);
      node_.Send(state);
    }
  }

  std::mutex mutex_;
  CrtkOperatingState state_;
  Eigen::Vector2d command_ = Eigen::Vector2d::Zero(), encoder_ = command_;
  std::vector<std::pair<TimeNs, Eigen::Vector2d>> truth_;
  std::atomic<bool> ends_{false};
  Ros2Node node_;
  std::thread thread_;
};

Eigen::Vector2d DesiredAt(double t_s) {
  const double swing = 1.0 - std::cos(2.0 * std::numbers::pi * t_s / 2.0);
  return {0.1 + 0.2 * swing, 0.1 * swing};
}

Recording Desired() {
  Recording wish;
  wish.has_shaft = false;
  Arm arm;
  for (int i = 0; i < 2; ++i) {
    ArmJoint joint;
    joint.a_m = 0.2;
    PlaceJoint(arm.convention, joint);
    arm.joints.push_back(joint);
  }
  wish.arm = arm;
  JointStream stream;
  stream.rate_hz = 100.0;
  stream.types = {JointType::kRevolute, JointType::kRevolute};
  stream.noise = {0.0, 0.0};
  for (int k = 0; k <= 200; ++k)
    stream.q.push_back(
        {1'700'000'000'000'000'000 + k * TimeNs{10'000'000}, Eigen::VectorXd(DesiredAt(0.01 * k))});
  wish.joints_command0 = stream;
  return wish;
}

/// How far the true joints were from the desired ones (root mean square), and how late. A command
/// waits for the network and for the robot's next step; how long is the machine's affair.
struct OffPath {
  double off = 0.0, late_s = 0.0;
};

double OffWhereLate(const std::vector<std::pair<TimeNs, Eigen::Vector2d>>& truth, TimeNs begin_ns,
                    double late_s) {
  double squares = 0.0;
  int count = 0;
  for (const auto& [t_ns, q] : truth) {
    const double t_s = 1e-9 * double(t_ns - begin_ns);
    if (t_s < 0.2 || t_s > 1.8) continue;
    squares += (q - DesiredAt(t_s - late_s)).squaredNorm();
    ++count;
  }
  return std::sqrt(squares / count);
}

OffPath OffThePath(const std::vector<std::pair<TimeNs, Eigen::Vector2d>>& truth, TimeNs begin_ns) {
  OffPath best{.off = std::numeric_limits<double>::infinity()};
  for (int ms = -100; ms <= 100; ++ms) {
    const double off = OffWhereLate(truth, begin_ns, 1e-3 * ms);
    if (off < best.off) best = {off, 1e-3 * ms};
  }
  return best;
}

TEST(JointControl, MovesARobotOverRos2) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "desired");
  WriteRecording(folder / "desired", Desired());
  folder.Write("model.yaml",
               "format: flextip-arm-model\nversion: 1\neffects:\n"
               "  servo_lag: {time_s: [0.05, 0.05]}\n  joint_offset: {offset: [0.02, 0]}\n");
  const auto address = [](const std::string& topic) {
    return "{ros2: {topic: PSM1/" + topic + ", domain: " + std::to_string(DomainOfTests()) + "}}\n";
  };
  const std::string session =
      "format: flextip-session\nversion: 1\njoints:\n  desired: desired\n"
      "  measured: " +
      address("measured_js") + "  command: " + address("servo_jp") +
      "  state: " + address("operating_state") + "  command_state: " + address("state_command");
  folder.Write("known.yaml", session + "model: model.yaml\n");
  Robot robot;
  const ProgramResult result = RunProgram({"control", (folder / "known.yaml").string(), "-o",
                                           (folder / "known").string(), "--duration", "20"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("the path is done"));
  const auto read = ReadRecording(folder / "known").recording;
  ASSERT_TRUE(read.joints0 && read.joints_command0);
  // The path began two seconds before its last command. Uncorrected joints are off by 20 mrad at
  // any time, and late by the lag of 50 ms.
  const OffPath path =
      OffThePath(robot.Truth(), read.joints_command0->q.back().t_ns - 2'000'000'000);
  EXPECT_LT(path.off, 0.001);
  EXPECT_GT(path.late_s, -0.02);
  EXPECT_LT(path.late_s, 0.02);
  testing::Test::RecordProperty("off", std::to_string(path.off));
  testing::Test::RecordProperty("late_s", std::to_string(path.late_s));
  const ProgramResult again =
      RunProgram({"replay", (folder / "known").string(), "-o", (folder / "again").string()});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("are the same bit for bit"));
}

}  // namespace
}  // namespace flextip::live
