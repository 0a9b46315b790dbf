// flextip import, as a user runs it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "recording/recording_reader.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;

/// A robot's log of forty rows, in mm and with decimal commas.
std::string RobotLog() {
  std::string text = "Time (s);TCP x;TCP y;TCP z\n";
  for (int i = 0; i < 40; ++i) {
    std::string row = fmt::format("{:.2f};{:.6f};{:.6f};{:.6f}\n", 0.02 * i,
                                  100 + 10 * std::sin(0.1 * i), 0.01 * ((i * 7) % 5), 20.5);
    for (char& c : row)
      if (c == '.') c = ',';
    text += row;
  }
  return text;
}

ProgramResult ImportCsv(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"import", "csv"});
  return RunProgram(arguments);
}

const std::vector<std::string> kInstrument{"--length",    "0.6",   "--diameter", "0.00238",
                                           "--stiffness", "0.304", "--port",     "0.28,0,-0.01"};

std::vector<std::string> With(std::vector<std::string> arguments,
                              const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(ImportCommand, MakesARecordingInOneCommandAndAgain) {
  const TestFolder folder;
  const auto log = folder.Write("robot.csv", RobotLog());
  const auto out = (folder / "first").string(), again = (folder / "second").string();
  const auto done = ImportCsv(With({log, "-o", out}, kInstrument));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("assumed wrist0.units.length: mm"));
  EXPECT_THAT(done.out,
              HasSubstr("wrist0: 40 samples, 0.78 s at 50 Hz, first at 0 s: 0.1, 0, "
                        "0.0205 m, orientation not measured (read as length mm, time s)"));
  EXPECT_THAT(done.out, HasSubstr("read back as it was written"));
  const auto summary = nlohmann::json::parse(ReadText(folder / "first/summary.json"));
  EXPECT_EQ(summary["command"], "import csv");
  EXPECT_EQ(summary["streams"][0]["samples"], 40);
  EXPECT_THAT(summary["assumed"].dump(), HasSubstr("wrist0.file"));
  EXPECT_TRUE(PageIsMadeAgain(folder / "first"));
  const auto repeated = ImportCsv({"--map", out + "/import.yaml", "-o", again});
  ASSERT_EQ(repeated.exit_code, 0) << repeated.err;
  for (const char* file : {"import.yaml", "wrist0/data.csv", "wrist0/sensor.yaml"}) {
    EXPECT_EQ(ReadText(folder / "first" / file), ReadText(folder / "second" / file)) << file;
  }
}

TEST(ImportCommand, ChecksTheRecording) {
  const TestFolder folder;
  const auto log = folder.Write("robot.csv", RobotLog());
  const auto out = (folder / "out").string();
  auto arguments = With({log, "-o", out}, kInstrument);
  *std::find(arguments.begin(), arguments.end(), "0.6") = "0.06";  // the port is out of reach
  const auto done = ImportCsv(arguments);
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("wrong: "));
  const auto findings = nlohmann::json::parse(ReadText(folder / "out/summary.json"))["findings"];
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0]["severity"], "wrong");
  EXPECT_THAT(ReadText(folder / "out/report.html"), HasSubstr(findings[0]["mend"]));
  arguments.insert(arguments.end(), {"--no-check", "--force"});
  EXPECT_THAT(ImportCsv(arguments).out, testing::Not(HasSubstr("wrong: ")));
}

TEST(ImportCommand, OptionsReplaceWhatTheMappingSays) {
  const TestFolder folder;
  const auto log = folder.Write("day1/robot.csv", RobotLog());
  ASSERT_EQ(ImportCsv(With({log, "-o", (folder / "a").string()}, kInstrument)).exit_code, 0);
  const auto other = folder.Write("day2/robot.csv", RobotLog());
  const auto done = ImportCsv({other, "--map", (folder / "a/import.yaml").string(), "--unit",
                               "wrist0=cm", "--offset", "wrist0=-2.5", "--set",
                               "wrist0.position_noise_m=0.0002", "-o", (folder / "b").string()});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, testing::Not(HasSubstr("assumed wrist0.units.length")));
  EXPECT_THAT(done.out, HasSubstr("first at -2.5 s: 1, 0, 0.205 m"));
  EXPECT_THAT(ReadText(folder / "b/import.yaml"), HasSubstr("day2/robot.csv"));
  EXPECT_EQ(ReadRecording(folder / "b").recording.wrist0->position_noise_m, 0.0002);
}

TEST(ImportCommand, NamesTheOptionForWhatIsMissing) {
  const TestFolder folder;
  const auto log = folder.Write("robot.csv", RobotLog());
  const auto out = (folder / "out").string();
  EXPECT_TRUE(IsRefused(ImportCsv({log, "-o", out}),
                        {"instrument.length_m", "--length M", "--stiffness NM2", "--port X,Y,Z"}));
  EXPECT_TRUE(IsRefused(ImportCsv(With({"--stream", "em0=" + log, "-o", out}, kInstrument)),
                        {"robot.csv", "em0 needs the columns qw", "--column em0.qw=COLUMN"}));
  EXPECT_TRUE(IsRefused(ImportCsv(With({"-o", out}, kInstrument)), {"no file"}));
  EXPECT_TRUE(IsRefused(ImportCsv(With({log, "-o", out, "--unit", "wrist0=apple"}, kInstrument)),
                        {"--unit", "'apple'"}));
  EXPECT_TRUE(IsRefused(ImportCsv(With({log, "-o", out, "--unit", "mm"}, kInstrument)),
                        {"--unit", "STREAM=UNIT"}));
  EXPECT_TRUE(IsRefused(ImportCsv(With({log, "-o", out, "--set", "em0.x=1"}, kInstrument)),
                        {"--set", "em0 has no setting"}));
  const auto bad = folder.Write("robot2.csv", "t [s],x [m],y [m],z [m]\n0,1,2,3\n0.1,1,b,3\n");
  EXPECT_TRUE(IsRefused(ImportCsv(With({bad, "-o", out}, kInstrument)),
                        {"robot2.csv:3", "\"b\"", "expected a finite number"}));
  EXPECT_TRUE(IsRefused(RunProgram(With({"import", "video", log, "-o", out}, kInstrument)),
                        {"--camera FILE"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(ImportCommand, SaysAllThatIsMissingAtOnce) {
  const TestFolder folder;
  const auto table = folder.Write("aurora.csv", "0,1,2,3,1,0,0,0\n0.1,1,2,3,1,0,0,0\n");
  EXPECT_TRUE(IsRefused(ImportCsv({"--stream", "em0=" + table, "-o", (folder / "out").string()}),
                        {"--length M, --diameter M, --stiffness NM2, --port X,Y,Z",
                         "--set em0.distance_from_tip_m=VALUE", "--quaternion em0=wxyz"}));
}

TEST(ImportCommand, ReadsABagInOneCommand) {
  const TestFolder folder;
  const std::string bag = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/bags/ros2_plain.mcap";
  const auto out = (folder / "out").string();
  const std::vector<std::string> told =
      With({"--set", "em0.distance_from_tip_m=0.02"}, kInstrument);
  EXPECT_TRUE(
      IsRefused(RunProgram(With({"import", "mcap", bag, "-o", out}, told)),
                {"wrist0 may be /PSM1/measured_cp, /PSM2/measured_cp", "--stream wrist0=TOPIC"}));
  const auto done = RunProgram(With({"import", "mcap", bag, "-o", out, "--stream",
                                     "wrist0=/PSM1/measured_cp", "--axis", "wrist0=z"},
                                    told));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("wrist0: 40 samples, 0.78 s at 50 Hz"));
  EXPECT_THAT(done.out, HasSubstr("joints0: 40 samples"));
  EXPECT_THAT(done.out, HasSubstr("cam0: 4 samples"));
  EXPECT_TRUE(PageIsMadeAgain(folder / "out"));
  EXPECT_TRUE(IsRefused(RunProgram({"import", "dvrk", out, "-o", (folder / "b").string()}),
                        {"holds no index.json"}));
}

}  // namespace
}  // namespace flextip
