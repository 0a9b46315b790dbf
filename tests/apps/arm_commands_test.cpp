// An arm's diagnosis and its use as a user runs them: what diagnose says of the closed loop, and
// the commands that control makes of desired joints.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "recording/cut.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/text/csv.h"
#include "simulation/joints/arm_recording.h"
#include "testdata/held_arm/arm_carrier.h"
#include "testdata/hidden/recording.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using simulation::ArmFaults;
using testing::HasSubstr;
using testing::Not;

ArmFaults LateAndOff() {
  ArmFaults faults;
  faults.command_delay_s = 0.04;
  faults.encoder_offset = Eigen::Vector3d(0.02, 0.0, 0.0);
  return faults;
}

class ArmCommands : public testing::Test {
 protected:
  void SetUp() override {
    Recording wish = simulation::RecordArm(arm_, {}, {.command = true, .encoders = false},
                                           {.seconds = 8.0, .seed = 9});
    Write("wish", wish);
  }
  void Write(const std::string& name, const Recording& recording) const {
    std::filesystem::create_directories(folder_ / name);
    WriteRecording(folder_ / name, recording);
  }
  ProgramResult Diagnose(std::vector<std::string> more = {}) const {
    const simulation::ArmSensors sensors{.command = true, .encoders = true, .seen = true};
    Write("rec", RecordArm(arm_, LateAndOff(), sensors, {.seconds = 12.0}));
    std::vector<std::string> command{"diagnose", (folder_ / "rec").string(), "-o",
                                     (folder_ / "out").string(), "--force"};
    command.insert(command.end(), more.begin(), more.end());
    return RunProgram(command);
  }
  ProgramResult Control(const std::string& wish, const std::string& model) const {
    return RunProgram({"control", (folder_ / wish).string(), "--model", (folder_ / model).string(),
                       "-o", (folder_ / "commands").string()});
  }
  nlohmann::json Json(const std::string& file) const {
    return nlohmann::json::parse(ReadText(folder_ / file));
  }

  const Arm arm_ = simulation::SmallArm();
  TestFolder folder_;
};

/// Where the links of the arm that is late and off are, less where they should be (rad).
double FirstJointOff(const JointStream& commands, const JointStream& wish) {
  const auto rows = Eigen::Index(commands.q.size());
  const ArmFaults faults = LateAndOff();
  Eigen::VectorXd t_s(rows);
  Eigen::MatrixXd of_motor(rows, 3);
  for (Eigen::Index k = 0; k < rows; ++k) {
    t_s[k] = 0.02 * double(k);
    of_motor.row(k) = (commands.q[std::size_t(k)].value + faults.encoder_offset).transpose();
  }
  const auto states = RunArm(PlantOf(simulation::SmallArm(), faults), t_s, of_motor);
  double squares = 0.0;
  int count = 0;
  for (Eigen::Index k = 75; k < rows - 5; ++k, ++count)
    squares += std::pow(states[std::size_t(k)].link[0] - wish.q[std::size_t(k)].value[0], 2);
  return std::sqrt(squares / count);
}

TEST_F(ArmCommands, TheModelBringsTheArmToItsDesiredJoints) {
  ASSERT_EQ(Diagnose().exit_code, 0);
  const auto diagnosis = Json("out/diagnosis.json");
  const auto& loop = diagnosis["closed_loop"];
  EXPECT_EQ(loop["controller"], "joint-feed-forward");
  EXPECT_LT(loop["after"]["rms_deviation_m"],
            0.05 * loop["before"]["rms_deviation_m"].get<double>());
  EXPECT_LT(loop["joints"][0]["rms_after"], 0.05 * loop["joints"][0]["rms_before"].get<double>());
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
  EXPECT_THAT(ReadText(folder_ / "out/report.html"), HasSubstr("feed-forward of its joints"));

  const ProgramResult result = Control("wish", "out/model.yaml");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NEAR(Json("commands/summary.json")["looks_ahead_s"].get<double>(), 0.04, 0.002);
  const auto wish = ReadRecording(folder_ / "wish").recording;
  const auto commands = ReadRecording(folder_ / "commands").recording;
  ASSERT_EQ(commands.joints_command0->q.size(), wish.joints_command0->q.size());
  const double before = FirstJointOff(*wish.joints_command0, *wish.joints_command0),
               after = FirstJointOff(*commands.joints_command0, *wish.joints_command0);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(after, 0.02 * before);
}

TEST_F(ArmCommands, NoClosedLoopSkipsIt) {
  ASSERT_EQ(Diagnose({"--no-closed-loop"}).exit_code, 0);
  EXPECT_FALSE(Json("out/diagnosis.json").contains("closed_loop"));
  EXPECT_THAT(ReadText(folder_ / "out/report.html"), Not(HasSubstr("feed-forward of its joints")));
}

TEST_F(ArmCommands, RefusesWhatIsNoWishAndNoModelOfAnArm) {
  const std::string good = "format: flextip-arm-model\nversion: 1\n";
  folder_.Write("good.yaml", good);
  folder_.Write("other.yaml", good + "effects:\n  joint_offset: {offset: [0.1, 0.2]}\n");
  folder_.Write("shaft.yaml", "format: flextip-model\nversion: 1\n");
  EXPECT_TRUE(IsRefused(Control("wish", "other.yaml"), {"joint_offset.offset", "expected 3"}));
  EXPECT_TRUE(IsRefused(Control("wish", "shaft.yaml"), {"shaft.yaml", "flextip-arm-model"}));
  EXPECT_TRUE(IsRefused(Control("nothing", "good.yaml"), {"nothing"}));
  EXPECT_TRUE(IsRefused(
      RunProgram({"control", (folder_ / "wish").string(), "-o", (folder_ / "commands").string()}),
      {"is a folder", "--model"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "commands"));
  EXPECT_EQ(Control("wish", "good.yaml").exit_code, 0);
}

/// Chi-squared per measurement of the states from `from_ns` on.
double MisfitFrom(const std::filesystem::path& states, TimeNs from_ns) {
  ReadLog log;
  CsvReader csv(states, {"timestamp [ns]", "chi2 []", "measurements []"}, log,
                {.allow_other_columns = true});
  double chi2 = 0.0, measurements = 0.0;
  while (csv.Next()) {
    if (csv.Integer(0) < from_ns) continue;
    chi2 += csv.Number(1);
    measurements += csv.Number(2);
  }
  return chi2 / measurements;
}

/// A shaft that an arm with a play of 30 mrad holds, commands 40 ms late, and the shaft is stiffer
/// or softer: fitted on the first 10 s, predicted and estimated on the others.
TEST_F(ArmCommands, AShaftThatAnArmHoldsIsDiagnosedPredictedAndEstimated) {
  ArmFaults faults{.play = Eigen::Vector3d(0.0, 0.03, 0.0), .command_delay_s = 0.04};
  hidden::ArmCarrier carrier(arm_, faults, true, 5);
  hidden::HiddenOptions options{.effects = {"stiffness"}, .carrier = &carrier};
  options.scene.motion = hidden::MotionKind::kSines;
  options.scene.load = hidden::LoadKind::kVarying;
  options.scene.duration_s = 18.0;
  const Recording whole = hidden::MakeHidden(options, 5).recording;
  const TimeNs start_ns = whole.joints0->q.front().t_ns, middle_ns = start_ns + 10'000'000'000,
               end_ns = whole.joints0->q.back().t_ns;
  Write("rec", Cut(whole, start_ns, middle_ns));
  Write("later", Cut(whole, middle_ns, end_ns));
  const std::string rec = (folder_ / "rec").string(), later = (folder_ / "later").string(),
                    out = (folder_ / "out").string(), model = out + "/model.yaml";
  const ProgramResult run = RunProgram({"diagnose", rec, "-o", out});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto found = Json("out/diagnosis.json");
  EXPECT_THAT(found["verdicts"],
              testing::ElementsAre("command_latency", "joint_backlash", "stiffness"));
  EXPECT_NEAR(found["parameters"]["joint_backlash"]["width"]["value"][1], 0.03, 0.001);
  EXPECT_NEAR(found["parameters"]["command_latency"]["delay_s"]["value"], 0.04, 0.004);
  EXPECT_EQ(found["arm"]["joints"].size(), 3U);
  const std::string page = ReadText(folder_ / "out/report.html");
  EXPECT_THAT(page, HasSubstr("width of joint 2 30"));
  EXPECT_THAT(page, HasSubstr(" mrad"));
  EXPECT_THAT(ReadText(folder_ / "out/arm_model.yaml"), HasSubstr("command_latency"));
  EXPECT_THAT(ReadText(model), Not(HasSubstr("command_latency")));
  ASSERT_EQ(RunProgram({"predict", later, "--model", model, "-o", (folder_ / "predicted").string()})
                .exit_code,
            0);
  EXPECT_LT(Json("predicted/summary.json")["ratio"].get<double>(), 0.2);
  ASSERT_EQ(
      RunProgram({"estimate", later, "--model", model, "-o", (folder_ / "estimated").string()})
          .exit_code,
      0);
  // Until the joint is dragged, where in its play it stands is not known: the first 2 s tell
  // nothing.
  EXPECT_LT(MisfitFrom(folder_ / "estimated/state0/data.csv", middle_ns + 2'000'000'000), 1.5);
  // Several of them, each with joints of its own, are not one diagnosis.
  EXPECT_TRUE(IsRefused(RunProgram({"diagnose", rec, later, "-o", (folder_ / "both").string()}),
                        {"rec: an arm holds the shaft"}));
}

}  // namespace
}  // namespace flextip
