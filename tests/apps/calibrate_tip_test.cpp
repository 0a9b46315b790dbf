// flextip calibrate tip as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "recording/calibrations/file.h"
#include "recording/recording_writer.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

const Eigen::Vector3d kTip(0.41, 0.004, -0.003), kPivot(0.3, 0.1, -0.2);

/// The tip held at kPivot; `sides` of turning about y and z.
Recording Pivoted(const Eigen::Vector3d& sides_rad, unsigned seed) {
  Recording recording;
  recording.instrument = {0.41, 0.005, 0.3, 0.0};
  recording.p_RP = {0.2, 0, 0};
  WristStream& wrist = recording.wrist0.emplace();
  wrist.rate_hz = 20;
  wrist.position_noise_m = 1e-4;
  wrist.orientation_noise_rad = 3e-4;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return DrawVector<3>(normal, random); };
  for (int i = 0; i < 80; ++i) {
    const double a = 0.3 * i;
    const Eigen::Vector3d w =
        sides_rad.cwiseProduct(Eigen::Vector3d(std::sin(0.4 * a), std::sin(a), std::cos(1.3 * a)));
    const Eigen::Matrix3d R = ExpRotation(w);
    WristSample sample;
    sample.p_RW = kPivot - R * kTip + wrist.position_noise_m * draw();
    sample.q_RW = Eigen::Quaterniond(ExpRotation(wrist.orientation_noise_rad * draw()) * R);
    wrist.samples.push_back({i * TimeNs{50'000'000}, sample});
  }
  return recording;
}

TEST(CalibrateTip, TheTipOnTheWristIsWritten) {
  const TestFolder folder;
  Recording recording = Pivoted({0.3, 0.3, 0.3}, 1);
  recording.wrist0->samples[17].value.p_RW.z() += 0.01;
  std::filesystem::create_directories(folder / "rec");
  WriteRecording(folder / "rec", recording);
  const auto run =
      RunProgram({"calibrate", "tip", (folder / "rec").string(), "-o", (folder / "out").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Calibration found = ReadCalibration(folder / "out/calibration.yaml");
  EXPECT_EQ(found.kind, "tip");
  const auto& tip = found.numbers.at("tip.p_WE");
  const Eigen::Vector3d e = Eigen::Vector3d(tip[0], tip[1], tip[2]) - kTip;
  EXPECT_LT(e.dot(Ldlt(found.CovarianceOf("tip.p_WE")).Solve(e)), 16.3);
  EXPECT_LT(e.norm(), 5e-4);
  EXPECT_EQ(found.CovarianceOf("pivot.p_R").rows(), 3);
  const auto summary = nlohmann::json::parse(ReadText(folder / "out/summary.json"));
  EXPECT_EQ(summary["status"], "ok");
  ASSERT_EQ(summary["outliers"].size(), 1u);
  EXPECT_EQ(summary["verdict"]["grade"], "good");
  EXPECT_THAT(summary["verdict"]["reasons"][0].get<std::string>(), testing::HasSubstr("1 pose"));
  EXPECT_EQ(summary["outliers"][0]["pose"], 17);
  EXPECT_THAT(summary["advice"].get<std::string>(), testing::HasSubstr("axis of W"));
  const std::string table = ReadText(folder / "out/residuals.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 81);
  EXPECT_THAT(ReadText(folder / "out/report.html"), testing::HasSubstr("around the pivot"));
  EXPECT_TRUE(PageIsMadeAgain(folder / "out"));
}

TEST(CalibrateTip, OneAxisIsNotEnough) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "rec");
  WriteRecording(folder / "rec", Pivoted({0, 0.5, 0}, 2));
  const auto run =
      RunProgram({"calibrate", "tip", (folder / "rec").string(), "-o", (folder / "out").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Calibration found = ReadCalibration(folder / "out/calibration.yaml");
  EXPECT_TRUE(found.numbers.empty());
  ASSERT_EQ(found.unobservable.size(), 2u);
  EXPECT_THAT(found.unobservable[0].reason, testing::HasSubstr("one axis only"));
  EXPECT_THAT(run.out, testing::HasSubstr("cannot be named"));
  const auto verdict = nlohmann::json::parse(ReadText(folder / "out/summary.json"))["verdict"];
  EXPECT_EQ(verdict["grade"], "not found");
  ASSERT_EQ(verdict["not_found"].size(), 1u);  // tip and pivot, for one reason
  EXPECT_EQ(verdict["not_found"][0]["parameter"], "tip.p_WE, pivot.p_R");
}

TEST(CalibrateTip, WhatIsNotThereIsAskedFor) {
  const TestFolder folder;
  Recording recording = Pivoted({0.3, 0.3, 0.3}, 3);
  for (auto& sample : recording.wrist0->samples) sample.value.q_RW.reset();
  std::filesystem::create_directories(folder / "rec");
  WriteRecording(folder / "rec", recording);
  const std::string rec = (folder / "rec").string(), out = (folder / "out").string();
  EXPECT_TRUE(IsRefused(RunProgram({"calibrate", "tip", rec, "-o", out}), {rec, "orientations"}));
  EXPECT_TRUE(IsRefused(RunProgram({"calibrate", "tip", rec, "-o", out, "--sensor", "em0"}),
                        {rec, "em0/"}));
}

}  // namespace
}  // namespace flextip
