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
  for (const char* page : {"out", "state"}) EXPECT_TRUE(PageIsMadeAgain(folder / page));
}

/// A camera that slips under a supervisor: what the run leaves is replayed, diagnosed, and drawn.
TEST(SimulateCommand, AStopLeavesAnExcerptForTheOtherCommands) {
  const TestFolder folder;
  const std::string scenario =
      std::string(FLEXTIP_SOURCE_DIR) + "/testdata/scenarios/camera_slips.yaml";
  const auto run = RunProgram({"simulate", scenario, "-o", (folder / "out").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Held at 3.0"));
  EXPECT_THAT(run.out, HasSubstr("the camera's tip was"));
  const std::string excerpt = (folder / "out/stops/1_tip_disagrees").string();
  for (const std::string& recording : {(folder / "out").string(), excerpt}) {
    const auto again =
        RunProgram({"replay", recording, "-o", (folder / "again").string(), "--force"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(again.out, HasSubstr("are the same bit for bit"));
  }
  const auto diagnosed = RunProgram({"diagnose", excerpt, "-o", (folder / "cause").string()});
  EXPECT_EQ(diagnosed.exit_code, 0) << diagnosed.err;
  for (const char* page : {"out", "out/stops/1_tip_disagrees"})
    EXPECT_TRUE(PageIsMadeAgain(folder / page));
  EXPECT_THAT(ReadText(folder / "out/report.html"), HasSubstr("\"name\":\"stop1-strips\""));
}

/// A plant with an effect, controlled and estimated with and without knowing of it.
TEST(SimulateCommand, AFoundModelHelpsTheControllersAndTheEstimate) {
  const TestFolder folder;
  std::string text = ReadText(kScenario);
  text.replace(text.find("controllers: all"), 16, "controllers: [rod-calculate]");
  const auto scenario =
      folder.Write("s.yaml", text + "\neffects:\n  precurvature: {curvature_1_m: [0.05, 0.04]}\n");
  const auto model =
      folder.Write("model.yaml",
                   "format: flextip-model\nversion: 1\ncentre_m: [0, 0, 0]\nstart_ns: 0\n"
                   "effects:\n  precurvature: {curvature_1_m: [0.05, 0.04]}\n");
  const auto run = [&](std::vector<std::string> command, const std::string& name) {
    const auto out = (folder / name).string();
    command.insert(command.end(), {"-o", out});
    const auto result = RunProgram(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(ReadText(folder / (name + "/summary.json")));
  };
  const auto deviation = [](const nlohmann::json& summary) {
    return summary["controllers"]["rod-calculate"]["rms_deviation_m"].get<double>();
  };
  const auto without = run({"simulate", scenario}, "without");
  const auto with = run({"simulate", scenario, "--model", model}, "with");
  EXPECT_LT(deviation(with), 0.2 * deviation(without));
  EXPECT_EQ(with["model"], "model.yaml");
  const std::string recording = (folder / "without").string();
  const auto blind = run({"estimate", recording, "--without-positions"}, "blind");
  const auto knowing =
      run({"estimate", recording, "--without-positions", "--model", model}, "knowing");
  EXPECT_LT(knowing["tip_rms_error_m"].get<double>(), 0.2 * blind["tip_rms_error_m"].get<double>());
}

// A port 3.6 mm from where it is registered: one sample cannot tell, a window of them can.
TEST(SimulateCommand, AWindowOfSamplesFindsThePort) {
  const TestFolder folder;
  const auto scenario = folder.Write("s.yaml", R"(
instrument: {length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}
port: {position_m: [0.0, 0.0, 0.17]}
wrist: {start_m: [-0.2457, 0.0, 0.3421], max_speed_m_s: 0.3}
load: {force_N: [0.25, -0.2, 0.45]}
effects: {port_offset: {offset_m: [0.0, 0.003, 0.002]}}
sensors:
  wrist: {rate_hz: 30, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}
  tip: {across_noise_m: 0.0001, depth_noise_m: 0.0002, direction_noise_rad: 0.003}
path:
  speed_m_s: 0.05
  waypoints: [{to_m: [0.0, 0.03, 0.0]}, {to_m: [0.0, 0.0, -0.03]}, {to_m: [0.0, -0.03, 0.0]}]
controllers: rod-track
)");
  const auto run = [&](std::vector<std::string> command, const std::string& name) {
    command.insert(command.end(), {"-o", (folder / name).string()});
    const auto result = RunProgram(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(ReadText(folder / (name + "/summary.json")));
  };
  run({"simulate", scenario}, "rec");
  const std::string recording = (folder / "rec").string();
  EXPECT_FALSE(run({"estimate", recording, "--port-prior", "0.005"}, "one").contains("window"));
  const auto summary =
      run({"estimate", recording, "--port-prior", "0.005", "--window", "20"}, "window");
  EXPECT_EQ(summary["window"]["status"], "ok");
  EXPECT_EQ(summary["window"]["samples"], 20);
  const auto shift = summary["window"]["port_shift_m"].get<std::vector<double>>();
  // Across the shaft; along it the port is never known.
  const Eigen::Vector3d along = Eigen::Vector3d(0.2457, 0.0, -0.1721).normalized();
  Eigen::Vector3d wrong = Eigen::Vector3d(shift[0], shift[1] - 0.003, shift[2] - 0.002);
  wrong -= along.dot(wrong) * along;
  EXPECT_LT(wrong.norm(), 0.0006);
}

/// The frames of one controller of two are written; the other recording is whole without them.
TEST(SimulateCommand, KeepsTheFramesThatAreAskedFor) {
  const TestFolder folder;
  const std::string source = FLEXTIP_SOURCE_DIR, data = source + "/testdata/";
  std::string text = ReadText(source + "/examples/clip.yaml");
  const auto replace = [&](const std::string& found, const std::string& replacement) {
    text.replace(text.find(found), found.size(), replacement);
  };
  replace("../testdata/", data);
  replace("../testdata/", data);
  replace("controllers: rod-track", "controllers: [rod-track, straight-track]");
  replace("-0.004]", "-0.001]");
  const auto scenario = folder.Write("s.yaml", text), out = (folder / "out").string();
  const auto run = [&](const std::string& names) {
    return RunProgram({"simulate", scenario, "--render", "--frames-of", names, "-o", out});
  };
  EXPECT_TRUE(IsRefused(run("flex-track"), {"flex-track", "rod-track, straight-track"}));
  const auto result = run("rod-track");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(std::filesystem::is_empty(folder / "out/rod-track/cam0/data"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/straight-track/cam0/data"));
  for (const std::string name : {"rod-track", "straight-track"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / ("out/" + name + "/last_frame.jpg"))) << name;
    const auto recording = (folder / ("out/" + name)).string();
    const auto state = RunProgram({"estimate", recording, "-o", (folder / name).string()});
    EXPECT_EQ(state.exit_code, 0) << state.err;
  }
  EXPECT_TRUE(PageIsMadeAgain(folder / "out"));
}

TEST(SimulateCommand, RefusesModelsThatMeanNothing) {
  const TestFolder folder;
  const auto out = (folder / "out").string();
  const auto model = folder.Write("model.yaml",
                                  "format: flextip-model\nversion: 1\ncentre_m: [0, 0, 0]\n"
                                  "start_ns: 0\neffects:\n  rust: {depth_m: 1}\n");
  EXPECT_TRUE(IsRefused(RunProgram({"simulate", kScenario, "--model", model, "-o", out}),
                        {"model.yaml:6:", "rust"}));
  EXPECT_TRUE(IsRefused(
      RunProgram({"simulate", kScenario, "--model", (folder / "none.yaml").string(), "-o", out}),
      {"none.yaml"}));
  EXPECT_FALSE(std::filesystem::exists(out));
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
