// flextip reproduce: the command that starts flextip-reproduce.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(ReproduceCommand, WritesTheTableOfAChapter) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  const auto result = RunProgram({"reproduce", "4", "--quick", "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("report.html"));
  EXPECT_THAT(ReadText(folder / "out/table.csv"),
              StartsWith("quantity,thesis,flextip,unit,note\n"));
  const auto summary = nlohmann::json::parse(ReadText(folder / "out/summary.json"));
  EXPECT_EQ(summary["command"], "reproduce");
  EXPECT_EQ(summary["chapters"][0]["chapter"], "4");
  EXPECT_GT(summary["chapters"][0]["numbers"], 10);
}

TEST(ReproduceCommand, TakesQuietBeforeOrBehindItsName) {
  for (const auto& arguments : {std::vector<std::string>{"-q", "reproduce", "4"},
                                {"reproduce", "-q", "4"},
                                {"reproduce", "4", "--quiet"}}) {
    const TestFolder folder;
    auto all = arguments;
    all.insert(all.end(), {"--quick", "-o", (folder / "out").string()});
    const auto result = RunProgram(all);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST(ReproduceCommand, RefusesAnUnknownChapter) {
  EXPECT_TRUE(IsRefused(RunProgram({"reproduce", "7", "-o", "out"}), {"7", "all"}));
}

}  // namespace
}  // namespace flextip
