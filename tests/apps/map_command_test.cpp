// flextip map.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kMaps = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/maps/";

std::vector<std::string> FigureNames(const nlohmann::json& figures) {
  std::vector<std::string> names;
  for (const auto& figure : figures) names.push_back(figure["name"]);
  return names;
}

TEST(MapCommand, WritesMapTableFiguresAndPage) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  const auto result = RunProgram({"map", kMaps + "thesis.yaml", "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto summary = nlohmann::json::parse(ReadText(folder / "out/summary.json"));
  const std::string map = ReadText(folder / "out/map.csv");
  EXPECT_THAT(map, StartsWith("#slice,p_AE_z [m],p_AE_y [m],p_AW_z [m]"));
  EXPECT_EQ(std::count(map.begin(), map.end(), '\n'),
            summary["slices"][0]["points"].get<long>() + 1);
  EXPECT_LT(summary["plan"][1]["max_deviation_m"].get<double>(),
            summary["plan"][0]["max_deviation_m"].get<double>());
  EXPECT_GT(summary["plan"][1]["length_m"].get<double>(),
            summary["plan"][0]["length_m"].get<double>());
  const auto figures = nlohmann::json::parse(ReadText(folder / "out/figures.json"));
  EXPECT_THAT(FigureNames(figures),
              testing::ElementsAre("norm", "bound", "angle", "v-sigma", "p-phi", "plan"));
  EXPECT_THAT(ReadText(folder / "out/table.csv"), StartsWith("quantity,value,unit,note\n"));
  EXPECT_THAT(ReadText(folder / "out/report.html"),
              HasSubstr("Motion errors across the workspace"));
  EXPECT_TRUE(PageIsMadeAgain(folder / "out"));
}

TEST(MapCommand, SaysHowLargeErrorsMayBe) {
  const TestFolder folder;
  const std::string text = ReadText(kMaps + "tolerance.yaml");
  const auto scenario = folder.Write("s.yaml", text);
  const auto result = RunProgram({"map", scenario, "-o", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto summary = nlohmann::json::parse(ReadText(folder / "out/summary.json"));
  EXPECT_EQ(summary["tolerance"][0]["status"], "ok");
  EXPECT_GT(summary["tolerance"][0]["scale"].get<double>(), 1.0);
  EXPECT_THAT(ReadText(folder / "out/map.csv"), HasSubstr("worst_norm_G []"));
}

TEST(MapCommand, RefusesAScenarioThatIsWrong) {
  const TestFolder folder;
  const auto scenario = folder.Write("s.yaml", "arm: {kind: planar}\ninstrument: {length: 1}\n");
  EXPECT_TRUE(IsRefused(RunProgram({"map", scenario, "-o", (folder / "out").string()}),
                        {"s.yaml:2: ", "length_m"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace flextip
