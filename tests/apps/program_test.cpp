// What holds for every command.
#include <gmock/gmock.h>

#include <algorithm>

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

TEST(Program, NamesWhatMayHaveBeenMeant) {
  EXPECT_TRUE(
      IsRefused(RunProgram({"trak", "rec"}), {"'trak' is no command; did you mean track?"}));
  EXPECT_TRUE(
      IsRefused(RunProgram({"calibrate", "camra"}),
                {"'camra' is no command; did you mean camera?", "flextip calibrate --help"}));
  // The unknown option comes before the missing -o that follows from it.
  EXPECT_TRUE(IsRefused(RunProgram({"diagnose", "rec", "--ouput", "out"}),
                        {"flextip diagnose has no option --ouput; did you mean --output?",
                         "flextip diagnose --help"}));
  EXPECT_TRUE(IsRefused(RunProgram({"estimate", "rec", "--window=many", "-o", "out"}),
                        {"--window", "flextip estimate --help"}));
  const auto far = RunProgram({"dance"});
  EXPECT_EQ(far.err.find("did you mean"), std::string::npos) << far.err;
}

TEST(Program, TakesHelpAndVersionAsWords) {
  EXPECT_EQ(RunProgram({"version"}).out, RunProgram({"--version"}).out);
  EXPECT_EQ(RunProgram({"help"}).out, RunProgram({"--help"}).out);
  EXPECT_EQ(RunProgram({"help", "calibrate", "tip"}).out,
            RunProgram({"calibrate", "tip", "--help"}).out);
}

TEST(Program, TakesOptionsOfEveryDayFromAFile) {
  const TestFolder folder;
  folder.Write("day.toml",
               "[shape]\nlength = 0.6\nstiffness = 0.304\nwrist = \"0,0,0\"\n"
               "port = \"0.28,0,0\"\n");
  const std::string file = (folder / "day.toml").string();
  const auto typed = RunProgram({"shape", "--length", "0.6", "--stiffness", "0.304", "--wrist",
                                 "0,0,0", "--port", "0.28,0,0", "--tip-force", "0,0,-2", "--json"});
  ASSERT_EQ(typed.exit_code, 0) << typed.err;
  const auto run = RunProgram({"--defaults", file, "shape", "--tip-force", "0,0,-2", "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, typed.out);
  // What is typed goes before.
  const auto longer = RunProgram(
      {"--defaults", file, "shape", "--tip-force", "0,0,-2", "--json", "--length", "0.5"});
  EXPECT_EQ(longer.exit_code, 0) << longer.err;
  EXPECT_NE(longer.out, typed.out);
  folder.Write("wrong.toml", "[shape]\nlenght = 0.6\n");
  EXPECT_TRUE(
      IsRefused(RunProgram({"--defaults", (folder / "wrong.toml").string(), "shape"}), {"lenght"}));
  EXPECT_TRUE(IsRefused(RunProgram({"--defaults", "no-such.toml", "shape"}), {"no-such.toml"}));
}

TEST(Program, KeepsNothingOfAnInterruptedCommandAndSaysSo) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  // A diagnosis takes seconds.
  const auto result =
      RunProgram({"--signal=INT", "--preserve-status", "1.5", FLEXTIP_PROGRAM, "diagnose",
                  FLEXTIP_SOURCE_DIR "/testdata/recordings/sample_2", "-o", out},
                 "/usr/bin/timeout");
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.err, HasSubstr("flextip: interrupted; nothing was kept"));
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

TEST(Program, SaysHowToBuildTheReproductionWhereItIsMissing) {
  const TestFolder folder;
  const auto alone = folder / "flextip";
  std::filesystem::copy_file(FLEXTIP_PROGRAM, alone);
  const auto result = RunProgram({"reproduce", "2", "-o", "out"}, alone.string());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, StartsWith("flextip: flextip-reproduce is neither beside"));
  EXPECT_THAT(result.err, HasSubstr("cmake --build build/release --target flextip-reproduce"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
}

TEST(ReportCommand, RefusesAFolderThatIsNoResult) {
  const TestFolder folder;
  folder.Write("empty/notes.txt", "nothing");
  EXPECT_TRUE(IsRefused(RunProgram({"report", (folder / "empty").string()}),
                        {"empty", "no summary.json, expected a folder that a command"}));
  folder.Write("torn/summary.json", R"({"command": "track", "version": "1"})");
  EXPECT_TRUE(IsRefused(RunProgram({"report", (folder / "torn").string()}),
                        {"torn", "no vision0/data.csv, the page needs it"}));
  EXPECT_TRUE(IsRefused(RunProgram({"report", (folder / "none").string()}), {"none"}));
}

}  // namespace
}  // namespace flextip
