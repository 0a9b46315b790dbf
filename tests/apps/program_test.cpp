// What holds for every command.
#include <gmock/gmock.h>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::string> kCommands{FLEXTIP_COMMANDS};

TEST(Program, SaysItsVersion) {
  const auto result = RunProgram({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, StartsWith("flextip "));
}

TEST(Program, ShowsAnExampleOfEveryCommand) {
  const auto help = RunProgram({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const auto& command : kCommands) {
    EXPECT_THAT(help.out, HasSubstr("  " + command + " "));
    const auto result = RunProgram({command, "--help"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.out, HasSubstr("\n  flextip " + command + " "));
  }
}

TEST(Program, RefusesWrongUsageInOneLine) {
  EXPECT_TRUE(IsRefused(RunProgram({}), {"subcommand"}));
  EXPECT_TRUE(IsRefused(RunProgram({"dance"}), {"dance"}));
  for (const auto& command : kCommands) {
    EXPECT_TRUE(IsRefused(RunProgram({command, "--no-such-option"}), {})) << command;
  }
}

}  // namespace
}  // namespace flextip
