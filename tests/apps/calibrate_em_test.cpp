// flextip calibrate em as a user runs it.
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

constexpr double kLength_m = 0.5, kDistance_m = 0.025;
const Pose kT_RF{ExpRotation({0.2, 1.0, -0.5}), {0.3, -0.4, 0.2}};

/// A shaft moved through a port; the sensor as the EM system has it, in F.
Recording Moved() {
  Recording recording;
  recording.instrument = {kLength_m, 0.003, 0.3, 0.0};
  recording.p_RP = {0.3, 0.02, -0.01};
  WristStream& wrist = recording.wrist0.emplace();
  EmStream& em = recording.em0.emplace();
  VisionStream& vision = recording.vision0.emplace();
  wrist.rate_hz = em.rate_hz = vision.rate_hz = 40;
  wrist.position_noise_m = 1e-4;
  em.position_noise_m = 3e-4;
  em.orientation_noise_rad = 2e-3;
  em.distance_from_tip_m = kDistance_m + 0.004;  // as it was guessed
  vision.direction_noise_rad = 1e-3;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return DrawVector<3>(normal, random); };
  for (int i = 0; i < 600; ++i) {
    const double a = 0.021 * i;
    const Eigen::Matrix3d R = ExpRotation({0, 0.4 * std::sin(3.1 * a), 0.4 * std::cos(4.3 * a)});
    const Eigen::Vector3d t = R.col(0), tip = recording.p_RP + (0.2 + 0.06 * std::sin(a)) * t;
    const TimeNs t_ns = (i + 1) * TimeNs{25'000'000};
    wrist.samples.push_back(
        {t_ns, {tip - kLength_m * t + wrist.position_noise_m * draw(), Eigen::Quaterniond(R)}});
    const Pose T_FS = kT_RF.Inverse() * Pose{ExpRotation(em.orientation_noise_rad * draw()) * R,
                                             tip - kDistance_m * t + em.position_noise_m * draw()};
    em.samples.push_back({t_ns, {T_FS.p, T_FS.Quaternion()}});
    const Eigen::Vector3d seen = (t + vision.direction_noise_rad * draw()).normalized();
    vision.tips.push_back(
        {t_ns, {TipStatus::kOk, tip + 1e-4 * draw(), 1e-8 * Eigen::Matrix3d::Identity(), seen}});
  }
  return recording;
}

TEST(CalibrateEm, TheSystemIsFoundByWristAndByVision) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "rec");
  WriteRecording(folder / "rec", Moved());
  for (const char* reference : {"wrist", "vision"}) {
    const auto run = RunProgram({"calibrate", "em", (folder / "rec").string(), "-o",
                                 (folder / reference).string(), "--reference", reference});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Calibration found = ReadCalibration(folder / reference / "calibration.yaml");
    EXPECT_EQ(found.kind, "em");
    const Pose& T_RF = found.poses.at("em0.T_RF");
    Eigen::Matrix<double, 7, 1> e;
    e << LogRotation(kT_RF.R * T_RF.R.transpose()), kT_RF.p - T_RF.p,
        kDistance_m - found.numbers.at("em0.distance_from_tip_m")[0];
    ASSERT_EQ(found.covariance.rows(), 7);
    EXPECT_LT(MahalanobisSquared(e, found.covariance), 24.3) << reference;  // 99.9 %
    EXPECT_FALSE(found.numbers.contains("em0.field"));
    const auto summary = nlohmann::json::parse(ReadText(folder / reference / "summary.json"));
    EXPECT_EQ(summary["status"], "ok");
    EXPECT_EQ(summary["samples"], 600);
    EXPECT_NEAR(summary["rms_direction_residual_rad"].get<double>(), 3e-3, 1.5e-3);
    EXPECT_THAT(ReadText(folder / reference / "report.html"), testing::HasSubstr("Errors where"));
    EXPECT_TRUE(PageIsMadeAgain(folder / reference));
  }
}

TEST(CalibrateEm, WhatIsNotThereIsAskedFor) {
  const TestFolder folder;
  Recording recording = Moved();
  recording.vision0.reset();
  std::filesystem::create_directories(folder / "rec");
  WriteRecording(folder / "rec", recording);
  const std::string rec = (folder / "rec").string(), out = (folder / "out").string();
  EXPECT_TRUE(IsRefused(RunProgram({"calibrate", "em", rec, "-o", out, "--reference", "vision"}),
                        {rec, "vision0/"}));
}

}  // namespace
}  // namespace flextip
