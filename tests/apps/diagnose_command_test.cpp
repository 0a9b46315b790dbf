// flextip diagnose: what it writes, what it refuses, and the options that change its answer.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "recording/cut.h"
#include "recording/recording_writer.h"
#include "testdata/hidden/recording.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Tags that are off by millimetres, a known load, 8 s.
hidden::HiddenRecording Hide(double duration_s) {
  hidden::HiddenOptions options{
      .effects = {"tag_offset"}, .size = hidden::EffectSize::kStrong, .exact = true};
  options.scene.duration_s = duration_s;
  options.scene.motion = hidden::MotionKind::kSines;
  options.scene.load = hidden::LoadKind::kVarying;
  return hidden::MakeHidden(options, 71);
}

class DiagnoseCommand : public testing::Test {
 protected:
  void Write(double duration_s) const { hidden::WriteHidden(folder_ / "rec", Hide(duration_s)); }

  ProgramResult Run(std::vector<std::string> more = {}) const {
    std::vector<std::string> command{"diagnose", (folder_ / "rec").string(), "-o",
                                     (folder_ / "out").string()};
    command.insert(command.end(), more.begin(), more.end());
    return RunProgram(command);
  }
  testing::AssertionResult Refuses(const std::vector<std::string>& parts) const {
    const ProgramResult result = Run();
    if (std::filesystem::exists(folder_ / "out"))
      return testing::AssertionFailure() << "left a folder behind";
    return IsRefused(result, parts);
  }
  nlohmann::json Json(const std::string& file) const {
    return nlohmann::json::parse(ReadText(folder_ / ("out/" + file)));
  }

  TestFolder folder_;
};

TEST_F(DiagnoseCommand, WritesItsAnswerAndWhatItRestsOn) {
  Write(8.0);
  const ProgramResult result = Run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, StartsWith("tag_offset ("));
  const auto diagnosis = Json("diagnosis.json");
  EXPECT_THAT(diagnosis["verdicts"], ElementsAre("tag_offset"));
  EXPECT_GT(diagnosis["probabilities"]["tag_offset"], 0.9);
  EXPECT_LT(diagnosis["gain"]["heldout_error_ratio"], 0.9);
  EXPECT_GT(diagnosis["closed_loop"]["before"]["rms_deviation_m"], 0.0);
  const auto summary = Json("summary.json");
  for (const char* key : {"command", "version", "seconds", "warnings"})
    EXPECT_TRUE(summary.contains(key)) << key;
  EXPECT_EQ(summary["verdicts"], diagnosis["verdicts"]);
  EXPECT_EQ(summary["samples"], 400);
  EXPECT_THAT(ReadText(folder_ / "out/model.yaml"),
              testing::AllOf(HasSubstr("format: flextip-model"), HasSubstr("tag_offset:")));
  EXPECT_THAT(ReadText(folder_ / "out/residuals.csv"), StartsWith("#t_s,"));
  const std::string page = ReadText(folder_ / "out/report.html");
  EXPECT_THAT(page, HasSubstr("tag_offset"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
  // Not a second time over it, and with --force the same again.
  EXPECT_TRUE(IsRefused(Run(), {"--force"}));
  const ProgramResult again = Run({"--force", "--no-closed-loop", "--quiet"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, "");
  EXPECT_FALSE(Json("diagnosis.json").contains("closed_loop"));
  EXPECT_EQ(Json("diagnosis.json")["probabilities"], diagnosis["probabilities"]);
}

TEST_F(DiagnoseCommand, LeavesOutWhatItIsToldTo) {
  Write(8.0);
  const ProgramResult result =
      Run({"--without", "tag_offset", "--without", "backlash", "--no-closed-loop"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto diagnosis = Json("diagnosis.json");
  for (const auto& [name, probability] : diagnosis["probabilities"].items()) {
    EXPECT_THAT(name, Not(HasSubstr("tag_offset")));
    EXPECT_THAT(name, Not(HasSubstr("backlash")));
  }
  EXPECT_THAT(diagnosis["catalogue"], Contains("stiffness"));
  EXPECT_THAT(diagnosis["catalogue"], Not(Contains("tag_offset")));
}

// The tags' offset is found in halves that together are as long as one recording.
TEST_F(DiagnoseCommand, TakesTheStretchesOfOneSessionAsOne) {
  const Recording whole = Hide(8.0).recording;
  const auto& wrist = whole.wrist0->samples;
  const TimeNs middle_ns = wrist[wrist.size() / 2].t_ns;
  WriteRecording(folder_ / "rec", Cut(whole, wrist.front().t_ns, middle_ns));
  WriteRecording(folder_ / "more", Cut(whole, middle_ns + 1, wrist.back().t_ns));
  const std::string more = (folder_ / "more").string();
  const ProgramResult result = Run({more, "--one-session", "--no-closed-loop"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto diagnosis = Json("diagnosis.json");
  EXPECT_THAT(diagnosis["verdicts"], ElementsAre("tag_offset"));
  EXPECT_GT(diagnosis["probabilities"]["tag_offset"], 0.9);
  EXPECT_FALSE(diagnosis.contains("recordings"));
}

TEST_F(DiagnoseCommand, RefusesAsOneSessionWhatDoesNotGoOn) {
  Write(8.0);
  const ProgramResult result = Run({(folder_ / "rec").string(), "--one-session"});
  EXPECT_TRUE(IsRefused(result, {"rec and rec_2", "the wrist begins", "from where it had ended"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(DiagnoseCommand, RefusesARecordingWithoutAWrist) {
  Write(2.0);
  std::filesystem::remove_all(folder_ / "rec/wrist0");
  EXPECT_TRUE(Refuses({"rec", "wrist0"}));
}

TEST_F(DiagnoseCommand, RefusesARecordingThatIsTooShort) {
  Write(2.0);
  const auto file = folder_ / "rec/wrist0/data.csv";
  std::string text = ReadText(file);
  std::size_t end = 0;
  for (int line = 0; line < 31; ++line) end = text.find('\n', end) + 1;
  folder_.Write("rec/wrist0/data.csv", text.substr(0, end));
  EXPECT_TRUE(Refuses({"rec", "30 samples", "40"}));
}

TEST_F(DiagnoseCommand, RefusesARecordingThatCannotContradictAnything) {
  Write(2.0);
  for (const char* sensor : {"em0", "strain0", "vision0", "load0"})
    std::filesystem::remove_all(folder_ / ("rec/" + std::string(sensor)));
  EXPECT_TRUE(Refuses({"rec", "nothing to judge"}));
}

TEST_F(DiagnoseCommand, RefusesAMissingFolder) { EXPECT_TRUE(Refuses({"rec"})); }

TEST_F(DiagnoseCommand, RefusesToLeaveOutWhatIsNone) {
  Write(2.0);
  EXPECT_TRUE(IsRefused(Run({"--without", "rust"}), {"rust"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST(DiagnoseHelp, HasAnExample) {
  const ProgramResult help = RunProgram({"diagnose", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("Example:\n  flextip diagnose recording -o "));
  for (const char* option : {"--without", "--tracked", "--no-closed-loop", "--force"})
    EXPECT_THAT(help.out, HasSubstr(option));
}

}  // namespace
}  // namespace flextip
