// flextip calibrate strain and stiffness on recordings of the plant, and what other commands make
// of their results.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "recording/calibrations/file.h"
#include "recording/recording_writer.h"
#include "run_program.h"
#include "tests/calibration/hung_masses.h"

namespace flextip {
namespace {

using ::testing::HasSubstr;

nlohmann::json SummaryOf(const std::filesystem::path& folder) {
  return nlohmann::json::parse(ReadText(folder / "summary.json"));
}

/// Amplified gages on a shaft that is softer than the recording says.
std::string Masses(const TestFolder& folder) {
  test_support::Bench bench;
  bench.gains = 200 * Eigen::Matrix4d::Identity();
  bench.gains(1, 0) = -6;
  bench.offset << 12, -30, 4, 55;
  bench.noise.reading = 0.15;
  bench.effects.stiffness_scale = 0.8;
  const auto masses = test_support::AllWays({-0.08, 0.0, 0.08}, {0.15, 0.3});
  Recording recording = RecordBench(bench, masses, Hang(bench, masses), 11);
  std::filesystem::create_directories(folder / "masses");
  WriteRecording(folder / "masses", recording);
  return (folder / "masses").string();
}

TEST(CalibrateLoads, GagesThenStiffnessThenAnEstimateThatFits) {
  TestFolder folder;
  const std::string masses = Masses(folder);
  const std::string gages = (folder / "gages").string(), shaft = (folder / "shaft").string();
  auto run = RunProgram({"calibrate", "strain", masses, "-o", gages});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* file : {"calibration.yaml", "residuals.csv", "figures.json", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "gages" / file)) << file;
  }
  EXPECT_TRUE(PageIsMadeAgain(folder / "gages"));
  const std::string gages_yaml = gages + "/calibration.yaml";
  run = RunProgram(
      {"calibrate", "stiffness", masses, "--calibration", gages_yaml, "-o", shaft, "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = SummaryOf(folder / "shaft");
  EXPECT_EQ(summary["status"], "ok");
  EXPECT_EQ(summary["verdict"]["grade"], "good");
  EXPECT_EQ(SummaryOf(folder / "gages")["verdict"]["grade"], "good");
  ASSERT_EQ(summary["calibrations"].size(), 1);
  EXPECT_EQ(summary["calibrations"][0]["kind"], "strain");
  const Calibration found = ReadCalibration(folder / "shaft" / "calibration.yaml");
  EXPECT_NEAR(found.numbers.at("instrument.bending_stiffness_Nm2")[0], 0.8 * 0.304, 0.003);

  // Without what was found the readings are no moments and the shaft is too stiff.
  const auto estimate = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"estimate", masses,   "-o", (folder / "out").string(),
                                          "--force",  "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return SummaryOf(folder / "out");
  };
  EXPECT_GT(estimate({})["chi2_per_measurement"], 100);
  const auto both =
      estimate({"--calibration", gages_yaml, "--calibration", shaft + "/calibration.yaml"});
  EXPECT_LT(both["chi2_per_measurement"], 1.5);
  ASSERT_EQ(both["calibrations"].size(), 2);
  EXPECT_EQ(both["calibrations"][1]["names"][0], "instrument.bending_stiffness_Nm2");
}

// The plant's E I falls by half of its mean from wrist to tip.
TEST(CalibrateLoads, AnEstimateTakesTheTaperThatWasFound) {
  TestFolder folder;
  test_support::Bench bench;
  bench.effects.taper = 0.25;  // 1 + 0.25 (1 - 2 s / L)
  const auto masses = test_support::AllWays({-0.08, 0.0, 0.08}, {0.15, 0.3});
  const Recording recording = RecordBench(bench, masses, Hang(bench, masses), 11);
  std::filesystem::create_directories(folder / "masses");
  WriteRecording(folder / "masses", recording);
  const auto run = [&](std::vector<std::string> command, const std::string& out) {
    command.insert(command.end(),
                   {(folder / "masses").string(), "-o", (folder / out).string(), "--quiet"});
    const auto result = RunProgram(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return SummaryOf(folder / out);
  };
  run({"calibrate", "stiffness"}, "shaft");
  const Calibration found = ReadCalibration(folder / "shaft" / "calibration.yaml");
  ASSERT_TRUE(found.numbers.contains("instrument.stiffness_taper"));
  const double sd = std::sqrt(found.CovarianceOf("instrument.stiffness_taper")(0, 0));
  EXPECT_NEAR(found.numbers.at("instrument.stiffness_taper")[0], -0.5, 4 * sd);
  const auto chi2 = [](const nlohmann::json& summary) {
    return summary["chi2_per_measurement"].get<double>();
  };
  run({"calibrate", "stiffness", "--model", "constant"}, "constant");
  const std::string tapered = (folder / "shaft/calibration.yaml").string(),
                    constant = (folder / "constant/calibration.yaml").string();
  const double with = chi2(run({"estimate", "--calibration", tapered}, "with"));
  EXPECT_LT(with, 1.2);
  EXPECT_GT(chi2(run({"estimate", "--calibration", constant}, "without")), 1.3 * with);
}

TEST(CalibrateLoads, CalibrationsThatDoNotFitAreRefused) {
  TestFolder folder;
  const std::string masses = Masses(folder);
  const std::string head = "format: flextip-calibration\nversion: 1\nkind: hand-eye\nfound:\n";
  const auto file = folder.Write("wrong.yaml", head + "  cam0.magic: 1\n");
  const std::string out = (folder / "out").string();
  EXPECT_TRUE(IsRefused(RunProgram({"estimate", masses, "-o", out, "--calibration", file}),
                        {"wrong.yaml", "cam0.magic", "unknown name"}));
  const auto camera = folder.Write("camera.yaml", head + "  cam0.intrinsics: [1, 1, 0, 0]\n");
  EXPECT_TRUE(IsRefused(RunProgram({"diagnose", masses, "-o", out, "--calibration", camera}),
                        {"camera.yaml", "cam0.intrinsics", "the recording has no cam0"}));
  EXPECT_TRUE(IsRefused(RunProgram({"estimate", masses, "-o", out, "--calibration", "/no/file"}),
                        {"/no/file"}));
}

TEST(CalibrateLoads, TheEmFieldIsTakenOut) {
  TestFolder folder;
  const test_support::Bench bench;
  const auto masses = test_support::AllWays({-0.08, 0.0, 0.08}, {0.15});
  Recording recording = RecordBench(bench, masses, Hang(bench, masses), 11);
  // Everything seems 5 % further from (0.5, 0, 0) than it is.
  const Eigen::Vector3d centre(0.5, 0, 0);
  for (auto& sample : recording.em0->samples) {
    sample.value.p_RS = centre + 1.05 * (sample.value.p_RS - centre);
  }
  std::filesystem::create_directories(folder / "bent");
  WriteRecording(folder / "bent", recording);
  // p - 0.05 / 1.05 (p - centre), with u = (p - centre) / 0.2.
  const std::string c = std::to_string(-0.2 * 0.05 / 1.05);
  const auto file = folder.Write(
      "field.yaml",
      "format: flextip-calibration\nversion: 1\nkind: em\nfound:\n  em0.field: [" + c +
          ", 0, 0, 0, " + c + ", 0, 0, 0, " + c +
          "]\n  em0.field_centre_m: [0.5, 0, 0]\n  em0.field_scale_m: [0.2, 0.2, 0.2]\n");
  const auto chi2 = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"estimate", (folder / "bent").string(),
                                          "-o",       (folder / "out").string(),
                                          "--force",  "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return SummaryOf(folder / "out")["chi2_per_measurement"].get<double>();
  };
  EXPECT_GT(chi2({}), 5);
  EXPECT_LT(chi2({"--calibration", file}), 1.5);
}

}  // namespace
}  // namespace flextip
