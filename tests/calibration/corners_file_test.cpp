#include "calibration/boards/corners_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

class CornersFileTest : public testing::Test {
 protected:
  fs::path file_ = fs::temp_directory_path() / fmt::format("flextip_corners_{}", getpid());
  ~CornersFileTest() override { fs::remove(file_); }

  void Write(const std::string& text) { std::ofstream(file_) << text; }
  std::string Refusal() {
    try {
      ReadCorners(file_);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
};

TEST_F(CornersFileTest, ReadsBackWhatItWrote) {
  CornersFile corners{"charuco:5x4:0.01:0.008:DICT_4X4_50", 640, 480, {}};
  BoardView part{"a, with a comma.png", {}};
  part.sighting.ids = {2, 7};
  part.sighting.px = {{1.0 / 3.0, 100.25}, {-0.5, 1e-7}};
  corners.views = {part, {"b.png", {}}};
  corners.views[1].sighting.reason = "no marker, none at all";
  WriteCorners(file_, corners);
  const CornersFile read = ReadCorners(file_);
  EXPECT_EQ(read.board, corners.board);
  EXPECT_EQ(read.width_px, 640);
  EXPECT_EQ(read.height_px, 480);
  ASSERT_EQ(read.views.size(), 2u);
  EXPECT_EQ(read.views[0].name, part.name);
  EXPECT_EQ(read.views[0].sighting.ids, part.sighting.ids);
  EXPECT_EQ(read.views[0].sighting.px, part.sighting.px);
  EXPECT_TRUE(read.views[0].sighting.x_B[1].isApprox(Eigen::Vector3d(0.04, 0.02, 0)));
  EXPECT_FALSE(read.views[1].sighting.Found());
  EXPECT_EQ(read.views[1].sighting.reason, "no marker; none at all");
}

TEST_F(CornersFileTest, RefusesWithFileAndLine) {
  const std::string head =
      "#flextip-corners 1\n#board chessboard:9x6:0.025\n#resolution 640 480\n"
      "#image,id [],x [px],y [px]\n";
  const std::pair<std::string, std::string> wrong[] = {
      {"", ":0"},
      {"#flextip-corners 2\n", ":1"},
      {"#flextip-corners 1\n#board chess\n", ":2"},
      {"#flextip-corners 1\n#board chessboard:9x6:0.025\n#resolution 640\n", ":3"},
      {head, ":"},
      {head + "a.png,0,1,2\na.png,0,1,2\n", ":6"},
      {head + "a.png,54,1,2\n", ":5"},
      {head + "a.png,0,nan,2\n", ":5"},
      {head + "a.png,0,1\n", ":5"},
      {head + "a.png,,,none\na.png,0,1,2\n", ":6"},
      {head + "a.png,0,1,2\nb.png,0,1,2\na.png,1,1,2\n", ":7"}};
  for (const auto& [text, line] : wrong) {
    Write(text);
    const std::string refusal = Refusal();
    EXPECT_NE(refusal.find(line == ":0" ? file_.string() : file_.string() + line),
              std::string::npos)
        << text << " -> " << refusal;
  }
  fs::remove(file_);
  EXPECT_NE(Refusal(), "");
}

}  // namespace
}  // namespace flextip
