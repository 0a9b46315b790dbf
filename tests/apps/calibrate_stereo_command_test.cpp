// flextip calibrate stereo as a user runs it, on drawn pictures of a board.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "recording/calibrations/file.h"
#include "recording/cameras/camera_file.h"
#include "tests/apps/run_program.h"
#include "tests/calibration/board_drawn.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr double kSquare_m = 0.006;
constexpr int kColumns = 7, kRows = 5;  // inner corners
constexpr int kPairs = 8;

const Pose kT_C0C1{ExpRotation({0.01, -0.05, 0.005}), {0.012, 0.0003, -0.0004}};

CameraCalibration Camera(int eye) {
  CameraCalibration c;
  c.width_px = 320;
  c.height_px = 240;
  c.fu_px = 300 + 6 * eye;
  c.fv_px = 302 + 6 * eye;
  c.cu_px = 162 - 3 * eye;
  c.cv_px = 118 + 2 * eye;
  c.distortion_coefficients = {-0.12 - 0.02 * eye, 0.03, 0, 0};
  return c;
}

/// Pictures of the board by both eyes, drawn once.
class CalibrateStereoCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const BoardTexture board = ChessboardTexture(kColumns + 1, kRows + 1);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-1, 1);
    for (int i = 0; i < kPairs; ++i) {
      Pose T_C0B;
      T_C0B.R = ExpRotation({0.5 * u(random), 0.5 * u(random), 0.3 * u(random)});
      const Eigen::Vector2d at = DrawVector<2>(u, random);
      T_C0B.p = Eigen::Vector3d(0.006 + 0.01 * at.x(), 0.008 * at.y(), 0.09) -
                T_C0B.R * Eigen::Vector3d(3 * kSquare_m, 2 * kSquare_m, 0);
      for (int eye = 0; eye < 2; ++eye) {
        const Pose T_CB = eye == 0 ? T_C0B : kT_C0C1.Inverse() * T_C0B;
        const Image image = DrawBoard(Camera(eye), T_CB, board, kSquare_m, {1, 1}, 2 * i + eye);
        pictures_.push_back(cv::Mat(image.height_px, image.width_px, CV_8UC1,
                                    const_cast<std::uint8_t*>(image.data.data()))
                                .clone());
      }
    }
  }
  static void TearDownTestSuite() { pictures_.clear(); }

  void SetUp() override {
    for (int i = 0; i < 2 * kPairs; ++i) {
      auto& names = i % 2 == 0 ? left_ : right_;
      names.push_back((folder_ / fmt::format("{}{}.png", i % 2 == 0 ? "l" : "r", i / 2)).string());
      ASSERT_TRUE(cv::imwrite(names.back(), pictures_[i]));
    }
  }

  ProgramResult Run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"calibrate", "stereo"};
    arguments.insert(arguments.end(), left_.begin(), left_.end());
    arguments.push_back("--right");
    arguments.insert(arguments.end(), right_.begin(), right_.end());
    arguments.insert(arguments.end(), {"-o", (folder_ / "out").string(), "--distortion",
                                       "radial-tangential", "--warp", "off"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (std::find(more.begin(), more.end(), "--board") == more.end()) {
      arguments.insert(arguments.end(), {"--board", "chessboard:7x5:0.006"});
    }
    return RunProgram(arguments);
  }

  static std::vector<cv::Mat> pictures_;
  std::vector<std::string> left_, right_;
  TestFolder folder_;
};
std::vector<cv::Mat> CalibrateStereoCommand::pictures_;

TEST_F(CalibrateStereoCommand, FindsBothCamerasAndWritesThem) {
  const Pose T_RC0{ExpRotation({0.3, -2.0, 0.7}), {0.4, 0.1, 0.3}};
  CameraCalibration placed = Camera(0);
  placed.T_RC = T_RC0;
  WriteCameraCalibration(folder_ / "pose.yaml", placed);
  const auto run = Run({"--pose", (folder_ / "pose.yaml").string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;

  const Calibration found = ReadCalibration(folder_ / "out/calibration.yaml");
  EXPECT_EQ(found.kind, "stereo");
  Eigen::Matrix<double, 6, 1> error;
  const Pose& T_C0C1 = found.poses.at("cam1.T_C0C1");
  error << LogRotation(kT_C0C1.R * T_C0C1.R.transpose()), kT_C0C1.p - T_C0C1.p;
  EXPECT_LT(error.tail<3>().norm(), 3e-4);
  EXPECT_LT(error.dot(Ldlt(found.CovarianceOf("cam1.T_C0C1")).Solve(error)), 22.5);  // 99.9 %
  for (int eye = 0; eye < 2; ++eye) {
    const std::string camera = fmt::format("cam{}", eye);
    const CameraCalibration truth = Camera(eye);
    EXPECT_EQ(found.texts.at(camera + ".distortion_model"), "radial-tangential");
    const auto& k = found.numbers.at(camera + ".intrinsics");
    const Eigen::Vector4d e = Eigen::Vector4d(k.data()) -
                              Eigen::Vector4d(truth.fu_px, truth.fv_px, truth.cu_px, truth.cv_px);
    EXPECT_LT(e.dot(Ldlt(found.CovarianceOf(camera + ".intrinsics")).Solve(e)), 18.5) << e;
    const auto file = ReadCameraCalibration(folder_ / ("out/" + camera + "/sensor.yaml"));
    EXPECT_EQ(file.fu_px, k[0]);
    EXPECT_EQ(file.distortion_coefficients, found.numbers.at(camera + ".distortion_coefficients"));
    EXPECT_TRUE(file.T_RC.Matrix().isApprox((eye == 0 ? T_RC0 : T_RC0 * T_C0C1).Matrix(), 1e-9));
    EXPECT_TRUE(fs::exists(folder_ / ("out/ros/" + camera + "_camera_info.yaml")));
  }

  const auto summary = nlohmann::json::parse(ReadText(folder_ / "out/summary.json"));
  EXPECT_EQ(summary["pairs_used"], kPairs);
  EXPECT_NEAR(summary["baseline_m"].get<double>(), T_C0C1.p.norm(), 1e-12);
  EXPECT_LT(summary["rms_reprojection_error_px"].get<double>(), 0.2);
  EXPECT_THAT(ReadText(folder_ / "out/report.html"), testing::HasSubstr("stereo-pairs"));
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
  const cv::FileStorage opencv((folder_ / "out/opencv_stereo.yml").string(), cv::FileStorage::READ);
  cv::Mat T;
  opencv["T"] >> T;
  ASSERT_EQ(T.total(), 3u);
  EXPECT_NEAR(cv::norm(T), T_C0C1.p.norm(), 1e-12);
}

TEST_F(CalibrateStereoCommand, SolvesAgainFromCornersWithoutPictures) {
  const std::vector<std::string> corners = {"--corners", (folder_ / "l.txt").string(),
                                            (folder_ / "r.txt").string()};
  ASSERT_EQ(Run(corners).exit_code, 0);
  const Calibration first = ReadCalibration(folder_ / "out/calibration.yaml");
  for (auto* names : {&left_, &right_}) {
    for (const std::string& name : *names) fs::remove(name);
  }
  std::vector<std::string> again = {"calibrate",
                                    "stereo",
                                    "--board",
                                    "chessboard:7x5:0.006",
                                    "-o",
                                    (folder_ / "out").string(),
                                    "--force",
                                    "--distortion",
                                    "radial-tangential",
                                    "--warp",
                                    "off"};
  again.insert(again.end(), corners.begin(), corners.end());
  const auto run = RunProgram(again);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Calibration second = ReadCalibration(folder_ / "out/calibration.yaml");
  // To rounding: sums are in the order of memory.
  EXPECT_TRUE(second.covariance.isApprox(first.covariance, 1e-6));
  EXPECT_TRUE(second.poses.at("cam1.T_C0C1")
                  .Matrix()
                  .isApprox(first.poses.at("cam1.T_C0C1").Matrix(), 1e-9));
}

TEST_F(CalibrateStereoCommand, RefusesWhatItCannotPair) {
  right_.pop_back();
  EXPECT_TRUE(IsRefused(Run(), {"8 left and 7 right"}));
  right_.push_back((folder_ / "none.png").string());
  EXPECT_TRUE(IsRefused(Run(), {"none.png"}));
  ASSERT_TRUE(cv::imwrite(right_.back(), cv::Mat(10, 20, CV_8UC1, cv::Scalar(9))));
  EXPECT_TRUE(IsRefused(Run(), {"none.png", "320x240", "20x10"}));
  EXPECT_TRUE(IsRefused(Run({"--board", "chessboard:7"}), {"chessboard:7"}));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CalibrateStereoCommand, WhereTheBoardIsNotSeenItSaysWhy) {
  left_.resize(1);
  right_.resize(1);
  const auto run = Run({"--board", "chessboard:9x8:0.006"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, testing::HasSubstr("left camera"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace flextip
