// flextip calibrate hand-eye as a user runs it, on drawn pictures of a board.
#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/rotation.h"
#include "recording/calibrations/file.h"
#include "recording/recording_writer.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kSquare_m = 0.01;
constexpr int kColumns = 7, kRows = 5;  // inner corners
constexpr int kFine = 4;                // pictures are drawn with sixteen times as many pixels

cv::Mat Shrunk(const cv::Mat& fine) {
  cv::Mat picture;
  cv::resize(fine, picture, {}, 1.0 / kFine, 1.0 / kFine, cv::INTER_AREA);
  return picture;
}

// A pixel of the fine picture where the board's (x, y) is seen, in squares.
Eigen::Vector2d Seen(const CameraCalibration& c, const Pose& T_CB, double x, double y) {
  const Eigen::Vector3d p = T_CB * Eigen::Vector3d(x * kSquare_m, y * kSquare_m, 0);
  const double u = c.fu_px * p.x() / p.z() + c.cu_px, v = c.fv_px * p.y() / p.z() + c.cv_px;
  return {(u + 0.5) * kFine - 0.5, (v + 0.5) * kFine - 0.5};
}

cv::Mat DrawChessboard(const CameraCalibration& c, const Pose& T_CB) {
  cv::Mat_<std::uint8_t> fine(c.height_px * kFine, c.width_px * kFine, std::uint8_t{150});
  const auto px = [&](double x, double y) {
    const Eigen::Vector2d at = Seen(c, T_CB, x, y);
    return cv::Point(static_cast<int>(std::lround(16 * at.x())),
                     static_cast<int>(std::lround(16 * at.y())));
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
  return Shrunk(fine);
}

// A ChArUco board of 9 x 8 squares, with all its markers or only those of the middle columns: one
// layout has them a column beside the other, so that only a row's ends tell which it is.
cv::Mat DrawCharuco(const CameraCalibration& c, const Pose& T_CB, bool with_ends) {
  constexpr int kSquare_px = 80, kSquares = 9, kDown = 8;
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  const auto board = cv::aruco::CharucoBoard::create(kSquares, kDown, 1.0F, 0.75F, dictionary);
  cv::Mat face;
  board->draw({kSquares * kSquare_px, kDown * kSquare_px}, face);
  for (int row = 0; row < kDown && !with_ends; ++row) {
    for (int column = 1 - row % 2; column < kSquares; column += 2) {
      if (column > 1 && column < kSquares - 2) continue;
      cv::rectangle(face, cv::Rect(column * kSquare_px, row * kSquare_px, kSquare_px, kSquare_px),
                    255, cv::FILLED);
    }
  }
  std::vector<cv::Point2f> on_face, on_fine;
  for (const auto& [x, y] : {std::pair(0, 0), {kSquares, 0}, {kSquares, kDown}, {0, kDown}}) {
    on_face.emplace_back(static_cast<float>(x * kSquare_px) - 0.5F,
                         static_cast<float>(y * kSquare_px) - 0.5F);
    const Eigen::Vector2f px = Seen(c, T_CB, x, y).cast<float>();
    on_fine.emplace_back(px.x(), px.y());
  }
  cv::Mat fine;
  cv::warpPerspective(face, fine, cv::getPerspectiveTransform(on_face, on_fine),
                      {c.width_px * kFine, c.height_px * kFine}, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, 200);
  return Shrunk(fine);
}

class CalibrateHandEyeCommand : public testing::Test {
 protected:
  static constexpr int kViews = 8;

  CalibrateHandEyeCommand() {
    camera_.width_px = 480;
    camera_.height_px = 360;
    camera_.fu_px = camera_.fv_px = 450;
    camera_.cu_px = 240;
    camera_.cv_px = 180;
  }

  static Pose BoardAt(int i) {
    Pose T_CB{ExpRotation(
                  {0.4 * std::sin(1 + 2.3 * i), 0.4 * std::cos(1.7 * i), 0.3 * std::sin(3.1 * i)}),
              {}};
    T_CB.p = Eigen::Vector3d(0.01 * std::sin(5.0 * i), 0.008 * std::cos(2.0 * i), 0.16) -
             T_CB.R * Eigen::Vector3d(0.03, 0.02, 0);
    return T_CB;
  }

  // A board on the wrist, or a camera: T_FC_ and T_KB_ hold in both.
  void Record(bool eye_in_hand, const std::function<cv::Mat(int)>& draw, bool video = false) {
    Recording r;
    r.instrument = {0.6, 0.005, 0.3, 0.0};
    r.cam0.emplace().calibration = camera_;
    r.cam0->calibration.rate_hz = 1;
    r.wrist0.emplace();
    r.wrist0->rate_hz = 1;
    r.wrist0->position_noise_m = 1e-4;
    r.wrist0->orientation_noise_rad = 1e-3;
    fs::create_directories(folder_ / "rec/cam0/data");
    cv::VideoWriter writer;
    if (video) {
      r.cam0->video = "frames.avi";
      writer.open((folder_ / "rec/cam0/frames.avi").string(),
                  cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 1,
                  {camera_.width_px, camera_.height_px});
      ASSERT_TRUE(writer.isOpened());
    }
    for (int i = 0; i < kViews; ++i) {
      const Pose T_FK = T_FC_ * BoardAt(i) * T_KB_.Inverse();
      const Pose T_RW = eye_in_hand ? T_FK.Inverse() : T_FK;
      const TimeNs t = i * 1'000'000'000LL;
      r.wrist0->samples.push_back({t, {T_RW.p, T_RW.Quaternion()}});
      if (video) {
        cv::Mat colour;
        cv::cvtColor(draw(i), colour, cv::COLOR_GRAY2BGR);
        writer.write(colour);
        r.cam0->frame_numbers.push_back({t, i});
      } else {
        const std::string name = std::to_string(i) + ".png";
        r.cam0->filenames.push_back({t, name});
        ASSERT_TRUE(cv::imwrite((folder_ / ("rec/cam0/data/" + name)).string(), draw(i)));
      }
    }
    WriteRecording(folder_ / "rec", r);
  }
  void RecordChessboard(bool eye_in_hand = false, bool video = false) {
    Record(
        eye_in_hand, [&](int i) { return DrawChessboard(camera_, BoardAt(i)); }, video);
  }

  ProgramResult Run(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"calibrate", "hand-eye", (folder_ / "rec").string(), "-o",
                                          (folder_ / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments);
  }
  nlohmann::json Summary() const {
    return nlohmann::json::parse(ReadText(folder_ / "out/summary.json"));
  }
  void ExpectFound(const std::string& camera, const std::string& board, const Pose& T_KB) const {
    const Calibration found = ReadCalibration(folder_ / "out/calibration.yaml");
    EXPECT_EQ(found.kind, "hand-eye");
    ASSERT_EQ(found.poses.count(camera), 1u);
    ASSERT_EQ(found.poses.count(board), 1u);
    EXPECT_LT((found.poses.at(camera).p - T_FC_.p).norm(), 5e-4);
    EXPECT_LT(LogRotation(found.poses.at(camera).R.transpose() * T_FC_.R).norm(), 3e-3);
    EXPECT_LT((found.poses.at(board).p - T_KB.p).norm(), 5e-4);
    EXPECT_EQ(found.CovarianceOf(camera).rows(), 6);
  }

  const TestFolder folder_;
  CameraCalibration camera_;
  const Pose T_FC_{ExpRotation({0.3, -2.0, 0.7}), {0.4, 0.1, 0.3}};
  const Pose T_KB_{ExpRotation({-0.5, 0.4, 1.0}), {0.1, 0.02, -0.03}};
};

TEST_F(CalibrateHandEyeCommand, FindsBothFramesAndWritesThem) {
  RecordChessboard();
  const auto run = Run({"--board", "chessboard:7x5:0.01"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectFound("cam0.T_RC", "board.T_WB", T_KB_);
  const auto summary = Summary();
  EXPECT_EQ(summary["views_used"], kViews);
  EXPECT_LT(summary["rms_reprojection_error_px"].get<double>(), 1.0);
  EXPECT_EQ(summary["mount"], "eye-to-hand");
  EXPECT_EQ(summary["verdict"]["grade"], "good");
  EXPECT_TRUE(fs::exists(folder_ / "out/residuals.csv"));
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
  EXPECT_FALSE(fs::is_empty(folder_ / "out/overlay"));
}

TEST_F(CalibrateHandEyeCommand, TheCameraMayBeOnTheWrist) {
  RecordChessboard(true);
  const auto run = Run({"--board", "chessboard:7x5:0.01", "--eye-in-hand"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectFound("cam0.T_WC", "board.T_RB", T_KB_);
  EXPECT_EQ(Summary()["mount"], "eye-in-hand");
  const auto wrong = Run({"--board", "chessboard:7x5:0.01", "--force"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("camera is on the wrist (--eye-in-hand)"));
  EXPECT_TRUE(IsRefused(Run({"--eye-in-hand"}), {"rec", "tags0", "--board"}));
}

TEST_F(CalibrateHandEyeCommand, FramesMayBeOfAVideo) {
  RecordChessboard(false, true);
  const auto run = Run({"--board", "chessboard:7x5:0.01"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  ExpectFound("cam0.T_RC", "board.T_WB", T_KB_);
  const auto summary = Summary();
  EXPECT_EQ(summary["views_used"], kViews);
  EXPECT_EQ(summary["views"][3]["view"], "frame 3");
  EXPECT_TRUE(fs::exists(folder_ / "out/overlay/00003.png"));
  // Every other frame, each with its own wrist pose.
  ASSERT_EQ(Run({"--board", "chessboard:7x5:0.01", "--views", "4", "--force"}).exit_code, 0);
  EXPECT_EQ(Summary()["views"].size(), 4u);
  EXPECT_EQ(Summary()["views"][1]["view"], "frame 2");
  EXPECT_LT(Summary()["rms_reprojection_error_px"], 1.0);
}

TEST_F(CalibrateHandEyeCommand, WhatOnePictureTellsOfACharucoBoardHoldsForAll) {
  Record(false, [&](int i) { return DrawCharuco(camera_, BoardAt(i), i == 5); });
  const auto run = Run({"--board", "charuco:9x8:0.01:0.0075:DICT_4X4_50"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Summary()["views_used"], kViews);
  ExpectFound("cam0.T_RC", "board.T_WB", T_KB_);
}

TEST_F(CalibrateHandEyeCommand, RefusesWhatItCannotUse) {
  RecordChessboard();
  EXPECT_TRUE(IsRefused(Run({}), {"rec", "tags0", "--board"}));
  EXPECT_TRUE(IsRefused(Run({"--board", "chessboard:7"}), {"chessboard:7"}));
  fs::remove_all(folder_ / "rec/wrist0");
  EXPECT_TRUE(IsRefused(Run({"--board", "chessboard:7x5:0.01"}), {"wrist0"}));
}

TEST_F(CalibrateHandEyeCommand, WhereTheBoardIsNotSeenItSaysWhy) {
  RecordChessboard();
  const auto run = Run({"--board", "chessboard:9x8:0.01"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("no chessboard with 9x8"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace flextip
