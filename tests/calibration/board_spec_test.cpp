#include <gtest/gtest.h>

#include "calibration/camera/camera_calibration.h"
#include "core/error.h"

namespace flextip {
namespace {

TEST(BoardSpec, ReadsEachKind) {
  const BoardSpec chessboard = ParseBoardSpec("chessboard:9x6:0.025");
  EXPECT_EQ(chessboard.kind, BoardKind::kChessboard);
  EXPECT_EQ(chessboard.columns, 9);
  EXPECT_EQ(chessboard.rows, 6);
  EXPECT_DOUBLE_EQ(chessboard.square_m, 0.025);
  const BoardSpec charuco = ParseBoardSpec("charuco:19x26:0.005:0.004:DICT_4X4_250");
  EXPECT_EQ(charuco.kind, BoardKind::kCharuco);
  EXPECT_DOUBLE_EQ(charuco.marker_m, 0.004);
  EXPECT_EQ(charuco.dictionary, "DICT_4X4_250");
  const BoardSpec grid = ParseBoardSpec("aprilgrid:6x6:0.03:0.009");
  EXPECT_EQ(grid.kind, BoardKind::kAprilGrid);
  EXPECT_DOUBLE_EQ(grid.marker_m, 0.009);
}

TEST(BoardSpec, RejectsWhatIsWrong) {
  for (const char* spec :
       {"", "chess:9x6:0.025", "chessboard", "chessboard:9x6", "chessboard:9x6:0.025:1",
        "chessboard:9:0.025", "chessboard:9x6x2:0.025", "chessboard:2x6:0.025",
        "chessboard:-9x6:0.025", "chessboard:9x6:0", "chessboard:9x6:-1", "chessboard:9x6:25mm",
        "chessboard:9x6:nan", "chessboard:9x6:inf", "chessboard:9x6:", "charuco:5x7:0.04:0.02",
        "charuco:5x7:0.02:0.04:DICT_4X4_50", "charuco:5x7:0.04:0.02:", "aprilgrid:6x6:0.03"}) {
    EXPECT_THROW(ParseBoardSpec(spec), InputError) << spec;
  }
}

}  // namespace
}  // namespace flextip
