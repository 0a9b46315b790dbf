// flextip check: what it prints and writes, and its exit codes.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "testdata/hidden/recording.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class CheckCommand : public testing::Test {
 protected:
  /// Writes a recording; em0 in millimetres where it is to be wrong.
  void Write(bool wrong) const {
    hidden::HiddenOptions options;
    options.scene.duration_s = 6.0;
    options.tick_rate_hz = 50.0;
    options.links_per_side = 30;
    hidden::HiddenRecording hidden = hidden::MakeHidden(options, 71);
    if (wrong)
      for (auto& s : hidden.recording.em0->samples) s.value.p_RS *= 1e3;
    hidden::WriteHidden(folder_ / "rec", hidden);
  }
  ProgramResult Run(std::vector<std::string> more = {}) const {
    std::vector<std::string> command{"check", (folder_ / "rec").string()};
    command.insert(command.end(), more.begin(), more.end());
    return RunProgram(command);
  }

  TestFolder folder_;
};

TEST_F(CheckCommand, SaysThatNothingWasFound) {
  Write(false);
  const ProgramResult result = Run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, StartsWith("wrist0 "));
  EXPECT_THAT(result.out, HasSubstr("\nem0 "));
  EXPECT_THAT(result.out, HasSubstr("\nnothing found\n"));
}

TEST_F(CheckCommand, NamesAndMendsWhatIsWrong) {
  Write(true);
  const ProgramResult result = Run({"-o", (folder_ / "out").string()});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("1 thing is wrong"));
  EXPECT_THAT(result.out, HasSubstr("wrong: em0: positions look like millimetres: "));
  EXPECT_THAT(result.out, HasSubstr("  mend: import with --unit em0=mm"));
  const auto summary = nlohmann::json::parse(ReadText(folder_ / "out/summary.json"));
  EXPECT_EQ(summary["command"], "check");
  EXPECT_EQ(summary["findings"][0]["finding"], "em0.unit");
  EXPECT_EQ(summary["wrong"], 1);
  EXPECT_THAT(ReadText(folder_ / "out/report.html"), HasSubstr("look like millimetres"));
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
}

TEST_F(CheckCommand, PrintsJson) {
  Write(true);
  const ProgramResult result = Run({"--json"});
  EXPECT_EQ(result.exit_code, 1);
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["findings"][0]["severity"], "wrong");
  EXPECT_EQ(json["streams"][0]["stream"], "wrist0");
}

TEST_F(CheckCommand, RefusesWhatIsNoRecording) { EXPECT_TRUE(IsRefused(Run(), {"rec"})); }

}  // namespace
}  // namespace flextip
