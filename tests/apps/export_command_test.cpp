// flextip export, as a user runs it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kRecordings = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/recordings/";

TEST(ExportCommand, WritesARecordingInEveryFormat) {
  const TestFolder folder;
  const auto mcap = (folder / "a/r.mcap").string();
  const auto result = RunProgram({"export", "mcap", kRecordings + "rendered", "-o", mcap});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("/cam0/image"));
  EXPECT_THAT(ReadText(mcap), StartsWith("\x89MCAP0\r\n"));
  EXPECT_TRUE(IsRefused(RunProgram({"export", "mcap", kRecordings + "rendered", "-o", mcap}),
                        {"r.mcap", "--force"}));
  for (const char* kind : {"tum", "csv"}) {
    const auto out = folder / kind;
    const auto texts = RunProgram({"export", kind, kRecordings + "sample_0", "-o", out.string()});
    ASSERT_EQ(texts.exit_code, 0) << texts.err;
    EXPECT_TRUE(std::filesystem::exists(out / (std::string("wrist0.") + kind)));
    const auto summary = nlohmann::json::parse(ReadText(out / "summary.json"));
    EXPECT_GT(summary["files"].size(), 2u);
  }
}

TEST(ExportCommand, DrawsTheFiguresOfAResult) {
  const TestFolder folder;
  const auto collar = (folder / "c").string(), out = (folder / "p").string();
  ASSERT_EQ(RunProgram({"collar", "-o", collar}).exit_code, 0);
  const auto result = RunProgram({"export", "pictures", collar, "--format", "pdf", "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(ReadText(folder / "p/tip.pdf"), StartsWith("%PDF"));
  EXPECT_THAT(ReadText(folder / "p/direction.pdf"), StartsWith("%PDF"));
}

TEST(ExportCommand, RefusesWhatIsNoResult) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  EXPECT_TRUE(IsRefused(RunProgram({"export", "pictures", kRecordings + "sample_0", "-o", out}),
                        {"report.html"}));
  EXPECT_TRUE(IsRefused(RunProgram({"export", "csv", kRecordings + "none", "-o", out}), {"none"}));
  EXPECT_TRUE(IsRefused(RunProgram({"export", "bag", kRecordings + "sample_0", "-o", out}), {}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace flextip
