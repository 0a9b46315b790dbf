// flextip collar and flextip board, as a user runs them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "recording/read_log.h"
#include "recording/streams/sensor_streams.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;

nlohmann::json SummaryIn(const std::filesystem::path& folder) {
  return nlohmann::json::parse(ReadText(folder / "summary.json"));
}

TEST(CollarCommand, MakesACollarWithOneCommand) {
  const TestFolder folder;
  const auto result = RunProgram({"collar", "-o", (folder / "c").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("6 tags of 4.8 mm"));
  for (const char* file : {"c/print.pdf", "c/print.png", "c/mount.stl", "c/drawing.svg",
                           "c/drawing.png", "c/accuracy.csv", "c/figures.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
  }
  ReadLog log;
  const TagCollar collar = ReadTags(folder / "c/tags0", log);
  EXPECT_TRUE(log.warnings.empty());
  EXPECT_EQ(collar.tags.size(), 6u);
  EXPECT_NEAR(collar.tags[0].size_m, 0.0048, 1e-12);
  const auto summary = SummaryIn(folder / "c");
  EXPECT_EQ(summary["verdict"]["grade"], "good");
  EXPECT_EQ(summary["accuracy"].size(), 11u);
  EXPECT_THAT(ReadText(folder / "c/report.html"), HasSubstr("flextip track pictures"));
  EXPECT_TRUE(PageIsMadeAgain(folder / "c"));
}

TEST(CollarCommand, ForceReplacesACollarWithoutACamera) {
  const TestFolder folder;
  const auto out = (folder / "c").string();
  ASSERT_EQ(RunProgram({"collar", "-o", out}).exit_code, 0);
  EXPECT_TRUE(IsRefused(RunProgram({"collar", "-o", out}), {"--force"}));
  const auto again = RunProgram({"collar", "-o", out, "--force"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(SummaryIn(folder / "c")["inputs"].empty());
}

TEST(CollarCommand, TakesLengthsWithUnits) {
  const TestFolder folder;
  const auto out = (folder / "c").string();
  const auto result = RunProgram({"collar", "--shaft", "0.8cm", "--tag", "6mm", "--faces", "8",
                                  "--distances", "0.05,80mm", "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto summary = SummaryIn(folder / "c");
  EXPECT_NEAR(summary["shaft_diameter_m"].get<double>(), 0.008, 1e-12);
  EXPECT_NEAR(summary["tag_size_m"].get<double>(), 0.006, 1e-12);
  EXPECT_NEAR(summary["accuracy"][10]["distance_m"].get<double>(), 0.08, 1e-12);
}

TEST(CollarCommand, RefusesWhatDoesNotFit) {
  const TestFolder folder;
  const auto out = (folder / "c").string();
  const auto collar = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"collar", "-o", out});
    return RunProgram(more);
  };
  EXPECT_TRUE(IsRefused(collar({"--shaft", "5"}), {"5000 mm"}));
  EXPECT_TRUE(IsRefused(collar({"--shaft", "5inch"}), {"inch"}));
  EXPECT_TRUE(IsRefused(collar({"--tag", "6mm", "--outer", "12mm"}), {"7.50 mm wide", "4.8 mm"}));
  EXPECT_TRUE(IsRefused(collar({"--distances", "50mm,500mm"}), {"9.1 px wide", "within 228 mm"}));
  EXPECT_TRUE(IsRefused(collar({"--camera", "none.yaml"}), {"none.yaml"}));
  EXPECT_TRUE(IsRefused(collar({"--paper", "a9"}), {"a9"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(BoardCommand, PrintsABoardAndSaysHowToCalibrateWithIt) {
  const TestFolder folder;
  const auto result = RunProgram({"board", "chessboard:8x5:0.02", "-o", (folder / "b").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto summary = SummaryIn(folder / "b");
  EXPECT_EQ(summary["verdict"]["command"],
            "flextip calibrate camera pictures/*.png --board chessboard:8x5:0.02 -o camera");
  EXPECT_NEAR(summary["width_m"].get<double>(), 0.18, 1e-12);
  EXPECT_TRUE(PageIsMadeAgain(folder / "b"));
  EXPECT_TRUE(IsRefused(RunProgram({"board", "chessboard:9x6:0.04", "-o", (folder / "d").string()}),
                        {"larger paper"}));
  EXPECT_TRUE(IsRefused(RunProgram({"board", "circles:9x6:0.04", "-o", (folder / "d").string()}),
                        {"circles"}));
}

}  // namespace
}  // namespace flextip
