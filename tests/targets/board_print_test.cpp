// Printed boards, rasterised by another program and found by the program's own detection.
#include "targets/board/print.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "targets/board/verdict.h"
#include "tests/targets/rasterise.h"

namespace flextip {
namespace {

class PrintedBoard : public testing::TestWithParam<const char*> {};

TEST_P(PrintedBoard, IsFoundWholeAndInItsSize) {
  if (!CanRasterise()) GTEST_SKIP() << "no pdftoppm (Debian: poppler-utils)";
  constexpr double kPxPerMm = 6.0;
  const BoardSpec board = ParseBoardSpec(GetParam());
  const BoardFace face = FaceOf(board);
  const BoardOnPaper place = PlaceBoard(face, PaperOf("a4"));
  const auto pdf = Scratch("print.pdf");
  PrintBoard(face, place, GetParam(), pdf);
  const Eigen::Vector2d size(place.paper.width_mm, place.paper.height_mm);
  const Image page = Rasterise(pdf, kPxPerMm, {Eigen::Vector2d(0, 0), size});
  const BoardSighting seen = DetectBoard(page, board);
  ASSERT_EQ(seen.px.size(), BoardCorners(board).size()) << seen.reason;
  for (std::size_t i = 0; i < seen.px.size(); ++i) {
    // Pixel (0, 0) is a pixel's centre: half a pixel from the page's corner.
    const Eigen::Vector2d at_mm = (seen.px[i] + Eigen::Vector2d(0.5, 0.5)) / kPxPerMm;
    const Eigen::Vector2d wanted = place.origin_mm + 1e3 * seen.x_B[i].head<2>();
    EXPECT_LT((at_mm - wanted).norm(), 0.02) << "corner " << seen.ids[i];
  }
}

INSTANTIATE_TEST_SUITE_P(Boards, PrintedBoard,
                         testing::Values("charuco:9x7:0.012:0.009:DICT_4X4_50",
                                         "chessboard:9x6:0.018",
                                         "charuco:7x6:0.02:0.015:DICT_5X5_100:old",
                                         "charuco:7x6:0.02:0.015:DICT_6X6_250",
                                         "aprilgrid:6x6:0.02:0.005", "aprilgrid:4x3:0.024:0.006"));

TEST(BoardPrint, RefusesWhatDoesNotFitAndSaysHowItWould) {
  const BoardFace face = FaceOf(ParseBoardSpec("chessboard:9x6:0.04"));
  try {
    PlaceBoard(face, PaperOf("a4"));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("larger paper"));
  }
  EXPECT_EQ(PlaceBoard(face, PaperOf("a2")).paper.name, "a2");
  EXPECT_THROW(FaceOf(ParseBoardSpec("aprilgrid:30x30:0.004:0.001")), InputError);  // 587 tags
}

TEST(BoardPrint, ReachIsThatOfAPinhole) {
  CameraCalibration camera;
  camera.width_px = 1000;
  camera.height_px = 800;
  camera.fu_px = camera.fv_px = 1000;
  const BoardFace face = FaceOf(ParseBoardSpec("chessboard:9x6:0.01"));  // 100 x 70 mm
  const BoardReach reach = ReachOf(face, camera);
  EXPECT_NEAR(reach.fills_at_m, 0.1, 1e-9);
  EXPECT_NEAR(reach.readable_to_m, 4.0, 1e-9);
}

}  // namespace
}  // namespace flextip
