// flextip simulate, and the commands that read what it wrote.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::string kScenario =
    std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/chapter4_up.yaml";

TEST(SimulateCommand, WritesARecordingPerControllerThatEstimateReads) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  const auto result = RunProgram({"simulate", kScenario, "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");  // no progress bar: stderr is no terminal
  const auto summary = nlohmann::json::parse(ReadText(folder / "out/summary.json"));
  ASSERT_EQ(summary["controllers"].size(), 6U);
  for (const auto& [name, figures] : summary["controllers"].items()) {
    EXPECT_GT(figures["max_deviation_m"].get<double>(), 0.0) << name;
    EXPECT_LE(figures["rms_deviation_m"], figures["max_deviation_m"]) << name;
    EXPECT_THAT(ReadText(folder / ("out/" + name + "/deviation.csv")),
                StartsWith("#timestamp [ns],p_desired_x [m],"));
    EXPECT_THAT(ReadText(folder / "out/report.html"), HasSubstr("\"name\":\"" + name + "\""));
  }
  const auto recording = (folder / "out/rod-track").string(), state = (folder / "state").string();
  const auto estimate = RunProgram({"estimate", recording, "-o", state});
  ASSERT_EQ(estimate.exit_code, 0) << estimate.err;
  EXPECT_THAT(ReadText(folder / "state/state0/data.csv"),
              StartsWith("#timestamp [ns],p_RE_x [m],"));
}

TEST(SimulateCommand, RefusesScenariosItCannotRun) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  const auto with = [&](const std::string& found, const std::string& replacement) {
    std::string text = ReadText(kScenario);
    EXPECT_THAT(text, HasSubstr(found));
    text.replace(text.find(found), found.size(), replacement);
    return RunProgram({"simulate", folder.Write("s.yaml", text), "-o", out});
  };
  EXPECT_TRUE(
      IsRefused(with("position_m: [0.28", "position_m: [0.78"), {"s.yaml:", "out of reach"}));
  EXPECT_TRUE(IsRefused(with("length_m: 0.6", "length_m: .nan"), {"s.yaml:", "length_m"}));
  EXPECT_TRUE(IsRefused(with("length_m: 0.6", "length_m: long"), {"s.yaml:", "length_m"}));
  EXPECT_TRUE(IsRefused(with("controllers: all", "controllers: [magic]"), {"s.yaml:", "magic"}));
  EXPECT_TRUE(IsRefused(with("port:", "prot:"), {"s.yaml", "port"}));
  EXPECT_TRUE(IsRefused(RunProgram({"simulate", (folder / "none.yaml").string(), "-o", out}),
                        {"none.yaml"}));
  EXPECT_TRUE(IsRefused(RunProgram({"simulate", kScenario, "--render", "-o", out}), {"camera"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace flextip
