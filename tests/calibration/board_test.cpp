// Boards found in pictures drawn from known cameras and poses: ids, frames, and how near.
#include "calibration/boards/board.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/rotation.h"
#include "tests/calibration/board_drawn.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

CameraCalibration Camera() {
  CameraCalibration c;
  c.width_px = 640;
  c.height_px = 480;
  c.fu_px = c.fv_px = 600;
  c.cu_px = 322;
  c.cv_px = 236;
  c.distortion_coefficients = {-0.25, 0.06, 0.001, -0.001};
  return c;
}

// A board of about 0.12 m by 0.1 m with its middle at `middle_B`, tilted and turned.
Pose TiltedPose(const Eigen::Vector2d& middle_B) {
  Pose T_CB;
  T_CB.R = ExpRotation({0.35, -0.3, 0.2});
  T_CB.p =
      Eigen::Vector3d(0.004, -0.003, 0.2) - T_CB.R * Eigen::Vector3d(middle_B.x(), middle_B.y(), 0);
  return T_CB;
}

// The root mean square distance to where the truth puts the same ids.
double RmsToTruth(const BoardSighting& seen, const BoardSpec& board, const Pose& T_CB) {
  const auto corners = BoardCorners(board);
  const CameraModel model(Camera());
  double sum = 0;
  for (std::size_t i = 0; i < seen.px.size(); ++i) {
    const Eigen::Vector3d& x_B = corners.at(static_cast<std::size_t>(seen.ids[i]));
    EXPECT_EQ(x_B, seen.x_B[i]);
    sum += (model.Project(T_CB * x_B).value() - seen.px[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(seen.px.size()));
}

// The face of a charuco board as this OpenCV prints it, and as earlier ones did: for an even number
// of rows the squares change colour, the markers keep their order.
BoardTexture CharucoTexture(int columns, int rows, bool old) {
  constexpr int kCells = 40, kMarker = 30, kGap = (kCells - kMarker) / 2;
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  BoardTexture t{cv::Mat_<std::uint8_t>(rows * kCells, columns * kCells, std::uint8_t{255}),
                 kCells};
  int id = 0;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const bool marker = (x + y) % 2 == (old ? 0 : 1);
      cv::Mat square = t.face(cv::Rect(x * kCells, y * kCells, kCells, kCells));
      if (!marker) {
        square.setTo(0);
        continue;
      }
      cv::Mat drawn;
      cv::aruco::drawMarker(dictionary, id++, kMarker, drawn, 1);
      drawn.copyTo(square(cv::Rect(kGap, kGap, kMarker, kMarker)));
    }
  }
  return t;
}

class Charuco : public testing::TestWithParam<bool> {};

TEST_P(Charuco, IsFoundInItsLayout) {
  const BoardSpec board = ParseBoardSpec("charuco:7x6:0.016:0.012:DICT_4X4_50");
  const Pose T_CB = TiltedPose({0.056, 0.048});
  const Image image = DrawBoard(Camera(), T_CB, CharucoTexture(7, 6, GetParam()), 0.016, {0, 0}, 1);
  const BoardSighting seen = DetectBoard(image, board);
  ASSERT_GE(seen.px.size(), 28u) << seen.reason;  // of 30
  EXPECT_EQ(seen.layout, GetParam() ? CharucoLayout::kOld : CharucoLayout::kPresent);
  const double rms_px = RmsToTruth(seen, board, T_CB);
  RecordProperty("rms_px", fmt::format("{:.4f}", rms_px));
  EXPECT_LT(rms_px, 0.08);
}

INSTANTIATE_TEST_SUITE_P(PresentAndOld, Charuco, testing::Values(false, true));

TEST(Board, PartsOfACharucoBoardAreEnough) {
  const BoardSpec board = ParseBoardSpec("charuco:7x5:0.016:0.012:DICT_4X4_50");
  Pose T_CB = TiltedPose({0.056, 0.04});
  T_CB.p.x() += 0.07;  // the right part is outside
  const Image image = DrawBoard(Camera(), T_CB, CharucoTexture(7, 5, false), 0.016, {0, 0}, 2);
  const BoardSighting seen = DetectBoard(image, board);
  ASSERT_GE(seen.px.size(), 6u) << seen.reason;
  EXPECT_LT(seen.px.size(), 24u);
  const double rms_px = RmsToTruth(seen, board, T_CB);
  RecordProperty("rms_px", fmt::format("{:.4f}", rms_px));
  EXPECT_LT(rms_px, 0.08);
}

// As Kalibr prints it: tag 0 lower left, black squares in the gaps' crossings.
BoardTexture AprilGridTexture(int columns, int rows) {
  constexpr int kTag = 8, kScale = 10, kPitch = 10;  // a gap of 2 cells: 0.25 of a tag
  BoardTexture t{
      cv::Mat_<std::uint8_t>(((rows - 1) * kPitch + kTag + 4) * kScale,
                             ((columns - 1) * kPitch + kTag + 4) * kScale, std::uint8_t{255}),
      kScale};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const TagCells tag = ReadTagCells("tag36h11", row * columns + column);
      const int left = 2 + column * kPitch, top = 2 + (rows - 1 - row) * kPitch;
      const int ring = (tag.cells - tag.border_cells) / 2;
      for (int y = 0; y < kTag; ++y) {
        for (int x = 0; x < kTag; ++x) {
          if (tag.At(x + ring, y + ring) != TagCells::kBlack) continue;
          t.face(cv::Rect((left + x) * kScale, (top + y) * kScale, kScale, kScale)).setTo(0);
        }
      }
    }
  }
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      t.face(cv::Rect(column * kPitch * kScale, row * kPitch * kScale, 2 * kScale, 2 * kScale))
          .setTo(0);
    }
  }
  return t;
}

TEST(Board, AprilGridAsKalibrPrintsIt) {
  const BoardSpec board = ParseBoardSpec("aprilgrid:4x3:0.024:0.006");
  const Pose T_CB = TiltedPose({0.057, 0.042});
  const Image image = DrawBoard(Camera(), T_CB, AprilGridTexture(4, 3), 0.003, {2, 2}, 3);
  const BoardSighting seen = DetectBoard(image, board);
  ASSERT_EQ(seen.px.size(), 48u) << seen.reason;
  const double rms_px = RmsToTruth(seen, board, T_CB);
  RecordProperty("rms_px", fmt::format("{:.4f}", rms_px));
  EXPECT_LT(rms_px, 0.08);
  // Tag 0 is lower left, its first corner too.
  const auto corners = BoardCorners(board);
  EXPECT_TRUE(corners[0].isApprox(Eigen::Vector3d(0, 0.084, 0)));
  EXPECT_TRUE(corners[2].isApprox(Eigen::Vector3d(0.024, 0.06, 0)));
}

TEST(Board, NoBoardHasAReason) {
  for (const char* spec : {"charuco:7x6:0.016:0.012:DICT_4X4_50", "aprilgrid:4x3:0.024:0.006",
                           "chessboard:9x6:0.025"}) {
    const BoardSighting seen = DetectBoard(Image(320, 240, 1), ParseBoardSpec(spec));
    EXPECT_FALSE(seen.Found());
    EXPECT_FALSE(seen.reason.empty()) << spec;
  }
  EXPECT_THROW(DetectBoard(Image(64, 48, 1), ParseBoardSpec("charuco:7x6:0.02:0.01:DICT_9X9")),
               InputError);
  EXPECT_THROW(DetectBoard(Image(64, 48, 1), ParseBoardSpec("charuco:20x20:0.02:0.01:DICT_4X4_50")),
               InputError);
}

// A real laparoscope's view of a printed board of the old layout: 19x26 squares, an inset over it.
TEST(Board, RealCharucoBoard) {
  const std::filesystem::path file = FLEXTIP_SHARED_DIR
      "/data/laparoscope/storz_tracked/pattern_4x4_19x26_5_4_with_inset_9x14.png";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
  const cv::Mat_<std::uint8_t> picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  Image image(picture.cols, picture.rows, 1);
  std::copy(picture.begin(), picture.end(), image.data.begin());
  const BoardSighting seen =
      DetectBoard(image, ParseBoardSpec("charuco:19x26:0.005:0.004:DICT_4X4_250"));
  EXPECT_EQ(seen.layout, CharucoLayout::kOld);
  ASSERT_GT(seen.px.size(), 350u);
  for (std::size_t i = 0; i < seen.px.size(); ++i) {  // squares of 50 pixels
    EXPECT_LT((seen.px[i] - (seen.x_B[i].head<2>() * 1e4 - Eigen::Vector2d(0.5, 0.5))).norm(), 0.1);
  }
}

}  // namespace
}  // namespace flextip
