// flextip calibrate hand-eye as a user runs it, on drawn pictures of a board.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rotation.h"
#include "recording/calibration_file.h"
#include "recording/recording_writer.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr double kSquare_m = 0.01;
constexpr int kColumns = 7, kRows = 5;  // inner corners

// A chessboard seen by a pinhole camera, drawn with sixteen times as many pixels.
cv::Mat DrawBoard(const CameraCalibration& c, const Pose& T_CB) {
  constexpr int kFine = 4;
  cv::Mat_<std::uint8_t> fine(c.height_px * kFine, c.width_px * kFine, std::uint8_t{150});
  const auto px = [&](double x, double y) {
    const Eigen::Vector3d p = T_CB * Eigen::Vector3d(x * kSquare_m, y * kSquare_m, 0);
    const double u = c.fu_px * p.x() / p.z() + c.cu_px, v = c.fv_px * p.y() / p.z() + c.cv_px;
    return cv::Point(static_cast<int>(std::lround(16 * ((u + 0.5) * kFine - 0.5))),
                     static_cast<int>(std::lround(16 * ((v + 0.5) * kFine - 0.5))));
  };
  const auto fill = [&](double x, double y, double w, double h, int grey) {
    const std::vector<cv::Point> corners = {px(x, y), px(x + w, y), px(x + w, y + h), px(x, y + h)};
    cv::fillConvexPoly(fine, corners, grey, cv::LINE_AA, 4);
  };
  fill(-2, -2, kColumns + 3, kRows + 3, 230);
  for (int row = -1; row < kRows; ++row) {
    for (int column = -1; column < kColumns; ++column) {
      if ((row + column) % 2 == 0) fill(column, row, 1, 1, 30);
    }
  }
  cv::Mat picture;
  cv::resize(fine, picture, cv::Size(c.width_px, c.height_px), 0, 0, cv::INTER_AREA);
  return picture;
}

class CalibrateHandEyeCommand : public testing::Test {
 protected:
  static constexpr int kViews = 8;

  void SetUp() override {
    CameraCalibration camera;
    camera.width_px = 480;
    camera.height_px = 360;
    camera.fu_px = camera.fv_px = 450;
    camera.cu_px = 240;
    camera.cv_px = 180;
    Recording r;
    r.instrument = {0.6, 0.005, 0.3, 0.0};
    r.cam0.emplace().calibration = camera;
    r.wrist0.emplace();
    r.wrist0->rate_hz = 1;
    r.wrist0->position_noise_m = 1e-4;
    r.wrist0->orientation_noise_rad = 1e-3;
    fs::create_directories(folder_ / "rec/cam0/data");
    for (int i = 0; i < kViews; ++i) {
      Pose T_CB{ExpRotation({0.4 * std::sin(1 + 2.3 * i), 0.4 * std::cos(1.7 * i),
                             0.3 * std::sin(3.1 * i)}),
                {}};
      T_CB.p = Eigen::Vector3d(0.01 * std::sin(5.0 * i), 0.008 * std::cos(2.0 * i), 0.16) -
               T_CB.R * Eigen::Vector3d(0.03, 0.02, 0);
      const Pose T_RW = T_RC_ * T_CB * T_WB_.Inverse();
      const TimeNs t = i * 1'000'000'000LL;
      r.wrist0->samples.push_back({t, {T_RW.p, T_RW.Quaternion()}});
      r.cam0->filenames.push_back({t, std::to_string(i) + ".png"});
      ASSERT_TRUE(cv::imwrite((folder_ / ("rec/cam0/data/" + std::to_string(i) + ".png")).string(),
                              DrawBoard(camera, T_CB)));
    }
    WriteRecording(folder_ / "rec", r);
  }

  ProgramResult Run(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"calibrate", "hand-eye", (folder_ / "rec").string(), "-o",
                                          (folder_ / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  }

  const TestFolder folder_;
  const Pose T_RC_{ExpRotation({0.3, -2.0, 0.7}), {0.4, 0.1, 0.3}};
  const Pose T_WB_{ExpRotation({-0.5, 0.4, 1.0}), {0.1, 0.02, -0.03}};
};

TEST_F(CalibrateHandEyeCommand, FindsBothFramesAndWritesThem) {
  const auto run = Run({"--board", "chessboard:7x5:0.01"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Calibration found = ReadCalibration(folder_ / "out/calibration.yaml");
  EXPECT_EQ(found.kind, "hand-eye");
  ASSERT_EQ(found.poses.count("cam0.T_RC"), 1u);
  EXPECT_LT((found.poses.at("cam0.T_RC").p - T_RC_.p).norm(), 5e-4);
  EXPECT_LT(LogRotation(found.poses.at("cam0.T_RC").R.transpose() * T_RC_.R).norm(), 3e-3);
  EXPECT_LT((found.poses.at("board.T_WB").p - T_WB_.p).norm(), 5e-4);
  EXPECT_EQ(found.CovarianceOf("cam0.T_RC").rows(), 6);
  const auto summary = nlohmann::json::parse(ReadText(folder_ / "out/summary.json"));
  EXPECT_EQ(summary["views_used"], kViews);
  EXPECT_LT(summary["rms_reprojection_error_px"].get<double>(), 1.0);
  EXPECT_TRUE(fs::exists(folder_ / "out/residuals.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "out/report.html"));
  EXPECT_FALSE(fs::is_empty(folder_ / "out/overlay"));
}

TEST_F(CalibrateHandEyeCommand, RefusesWhatItCannotUse) {
  EXPECT_TRUE(IsRefused(Run({}), {"rec", "tags0", "--board"}));
  EXPECT_TRUE(IsRefused(Run({"--board", "chessboard:7"}), {"chessboard:7"}));
  fs::remove_all(folder_ / "rec/wrist0");
  EXPECT_TRUE(IsRefused(Run({"--board", "chessboard:7x5:0.01"}), {"wrist0"}));
}

TEST_F(CalibrateHandEyeCommand, WhereTheBoardIsNotSeenItSaysWhy) {
  const auto run = Run({"--board", "chessboard:9x8:0.01"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, testing::HasSubstr("no chessboard with 9x8"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace flextip
