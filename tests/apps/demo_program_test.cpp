// The smaller program of scripts/demo against flextip itself.
#include <gmock/gmock.h>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

ProgramResult RunDemo(const std::vector<std::string>& arguments) {
  return RunProgram(arguments, FLEXTIP_DEMO_PROGRAM);
}

TEST(DemoProgram, HasTwoCommandsAndSaysWhereTheOthersAre) {
  const auto help = RunDemo({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("  simulate "));
  EXPECT_THAT(help.out, HasSubstr("  track "));
  EXPECT_THAT(help.out, Not(HasSubstr("diagnose")));
  EXPECT_THAT(help.out, HasSubstr("scripts/build"));
  EXPECT_TRUE(IsRefused(RunDemo({"simulate", "s.yaml", "--serve", "0"}), {"scripts/build"}));
}

TEST(DemoProgram, WritesTheRecordingsOfFlextip) {
  const TestFolder folder;
  const std::string scenario = FLEXTIP_SOURCE_DIR "/testdata/scenarios/bent_press.yaml";
  const auto run = [&](const std::string& program, const std::string& name) {
    const auto result = RunProgram({"simulate", scenario, "-o", (folder / name).string()}, program);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  };
  run(FLEXTIP_PROGRAM, "whole");
  run(FLEXTIP_DEMO_PROGRAM, "demo");
  int compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "whole")) {
    if (entry.path().extension() != ".csv") continue;
    const fs::path place = fs::relative(entry.path(), folder / "whole");
    EXPECT_EQ(ReadText(folder / "demo" / place), ReadText(entry.path())) << place;
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

}  // namespace
}  // namespace flextip
