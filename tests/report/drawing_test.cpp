// Pictures of figures, judged by their pixels.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "core/error.h"
#include "report/drawing/axis.h"
#include "report/drawing/picture.h"

namespace flextip::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// A fresh folder of the running test, removed at its end.
class Folder {
 public:
  Folder()
      : path_(std::filesystem::path(testing::TempDir()) /
              fmt::format("flextip_drawing_{}_{}", getpid(),
                          testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

std::vector<std::string> Texts(const Axis& axis, int count) {
  std::vector<std::string> texts;
  for (const auto& tick : axis.Ticks(count)) texts.push_back(tick.text);
  return texts;
}

/// Returns the box around all pixels of exactly this colour (#rrggbb); empty where there is none.
cv::Rect BoxOf(const cv::Mat& picture, int r, int g, int b) {
  cv::Mat same;
  cv::inRange(picture, cv::Scalar(b, g, r), cv::Scalar(b, g, r), same);
  return cv::boundingRect(same);
}

cv::Mat Drawn(const Folder& folder, const Figure& figure) {
  const auto file = folder / "figure.png";
  WritePicture(file, {figure});
  return cv::imread(file.string());
}

TEST(Axis, HasRoundTicks) {
  EXPECT_THAT(Texts(Axis(0.0, 1.0), 5), ElementsAre("0", "0.2", "0.4", "0.6", "0.8", "1"));
  EXPECT_THAT(Texts(Axis(-12.0, 31.0), 4), ElementsAre("0", "20"));
  EXPECT_THAT(Texts(Axis(0.5, 2000.0, true), 6), ElementsAre("1", "10", "100", "1000"));
  EXPECT_DOUBLE_EQ(Axis(1.0, 100.0, true).Share(10.0), 0.5);
}

TEST(Axis, TakesWhatHasNoLength) {
  EXPECT_DOUBLE_EQ(Axis(3.0, 3.0).Share(3.0), 0.5);
  EXPECT_DOUBLE_EQ(Axis(0.0, 0.0).Share(0.0), 0.5);
  EXPECT_DOUBLE_EQ(Axis(std::numeric_limits<double>::infinity(), 0.0).Share(0.5), 0.5);
}

TEST(Picture, DrawsAHigherValueHigher) {
  const Folder folder;
  Figure figure{.title = "t"};
  figure.traces = {{.x = {0.0, 1.0}, .y = {0.0, 0.0}, .color = "#ff0000"},
                   {.x = {0.0, 1.0}, .y = {2.0, 2.0}, .color = "#00ff00"}};
  cv::Mat picture = Drawn(folder, figure);
  const cv::Rect low = BoxOf(picture, 255, 0, 0), high = BoxOf(picture, 0, 255, 0);
  ASSERT_FALSE(low.empty());
  ASSERT_FALSE(high.empty());
  EXPECT_LT(high.y, low.y);
  EXPECT_EQ(high.width, low.width);
  EXPECT_GT(high.width, picture.cols / 2);
  figure.y_down = true;
  picture = Drawn(folder, figure);
  EXPECT_GT(BoxOf(picture, 0, 255, 0).y, BoxOf(picture, 255, 0, 0).y);
}

TEST(Picture, KeepsASquareSquare) {
  const Folder folder;
  Figure figure{.equal_axes = true};
  figure.traces = {
      {.x = {0.0, 3.0, 3.0, 0.0, 0.0}, .y = {0.0, 0.0, 3.0, 3.0, 0.0}, .color = "#ff0000"}};
  const cv::Rect box = BoxOf(Drawn(folder, figure), 255, 0, 0);
  EXPECT_NEAR(box.width, box.height, 3);
  EXPECT_GT(box.width, 200);
}

TEST(Picture, LeavesAGapWhereAValueIsMissing) {
  const Folder folder;
  const double gap = std::numeric_limits<double>::quiet_NaN();
  Figure figure;
  figure.traces = {
      {.x = {0.0, 1.0, 2.0, 3.0, 4.0}, .y = {1.0, 1.0, gap, 1.0, 1.0}, .color = "#ff0000"}};
  const cv::Mat picture = Drawn(folder, figure);
  const cv::Rect box = BoxOf(picture, 255, 0, 0);
  ASSERT_FALSE(box.empty());
  const cv::Rect middle(box.x + box.width * 3 / 8, box.y, box.width / 4, box.height);
  EXPECT_TRUE(BoxOf(picture(middle), 255, 0, 0).empty());
}

TEST(Picture, BarsAreAsLongAsTheirValues) {
  const Folder folder;
  const auto kBars = FigureTrace::Kind::kBars;
  Figure figure{.lying_bars = true};
  figure.traces = {
      {.kind = kBars, .y = {1.0, 4.0}, .labels = {"a", "b"}, .colors = {"#ff0000", "#00ff00"}}};
  const cv::Mat picture = Drawn(folder, figure);
  const cv::Rect a = BoxOf(picture, 255, 0, 0), b = BoxOf(picture, 0, 255, 0);
  EXPECT_NEAR(4.0 * a.width, b.width, 8);
  EXPECT_GT(b.y, a.y) << "the first bar is the highest";
}

TEST(Picture, ColoursAFieldByItsValues) {
  const Folder folder;
  Figure figure;
  figure.fields = {
      {.name = "angle", .x = {0.0, 1.0}, .y = {0.0, 1.0}, .values = {0.0, 1.0, 1.0, 1.0}}};
  const cv::Mat picture = Drawn(folder, figure);
  const cv::Rect least = BoxOf(picture, 0xf7, 0xfb, 0xff);
  ASSERT_FALSE(least.empty());
  EXPECT_LT(least.x, picture.cols / 2);
  EXPECT_GT(least.y + least.height, picture.rows / 2);
}

/// Strips: lines as thick as asked, a row each by its name, the first on top.
TEST(Picture, DrawsStripsOneBelowTheOther) {
  const Folder folder;
  Figure figure{.x_label = "time (s)", .y_down = true, .y_names = {"camera", "robot"}};
  figure.traces.push_back({.x = {0, 1}, .y = {0, 0}, .color = "#ff0000", .width = 16.0});
  figure.traces.push_back({.x = {0, 1}, .y = {1, 1}, .color = "#00ff00", .width = 4.0});
  const cv::Mat picture = Drawn(folder, figure);
  const cv::Rect thick = BoxOf(picture, 255, 0, 0), thin = BoxOf(picture, 0, 255, 0);
  EXPECT_LT(thick.br().y, thin.y);
  EXPECT_NEAR(static_cast<double>(thick.height) / thin.height, 4.0, 1.0);
}

TEST(Picture, HasColumns) {
  const Folder folder;
  Figure left, right;
  left.traces.push_back({.x = {0, 1}, .y = {0, 1}, .color = "#ff0000"});
  right.traces.push_back({.x = {0, 1}, .y = {0, 1}, .color = "#00ff00"});
  WritePicture(folder / "one.png", {left});
  WritePicture(folder / "four.png", {left, right, right, left}, 2);
  const cv::Mat one = cv::imread((folder / "one.png").string());
  const cv::Mat four = cv::imread((folder / "four.png").string());
  EXPECT_EQ(four.size(), cv::Size(2 * one.cols, 2 * one.rows));
  const cv::Rect cell(0, 0, one.cols, one.rows);
  EXPECT_EQ(BoxOf(four(cell), 255, 0, 0), BoxOf(one, 255, 0, 0));
  EXPECT_EQ(BoxOf(four(cell + cv::Point(one.cols, one.rows)), 255, 0, 0), BoxOf(one, 255, 0, 0));
  EXPECT_EQ(BoxOf(four(cell + cv::Point(one.cols, 0)), 0, 255, 0), BoxOf(one, 255, 0, 0));
  EXPECT_TRUE(BoxOf(four(cell + cv::Point(0, one.rows)), 255, 0, 0).empty());
}

TEST(Picture, IsSvgPdfOrPngByItsName) {
  const Folder folder;
  Figure figure{.title = "A path", .x_label = "x (mm)", .y_label = "y (mm)", .z_label = "z (mm)"};
  figure.traces = {{.name = "path", .x = {0.0, 1.0}, .y = {0.0, 2.0}, .z = {0.0, 3.0}}};
  const auto text = [&](const char* name) {
    WritePicture(folder / name, {figure, figure});
    std::ifstream in(folder / name, std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
  };
  EXPECT_THAT(text("a.svg"), HasSubstr("<svg"));
  EXPECT_THAT(text("a.pdf"), StartsWith("%PDF"));
  EXPECT_THAT(text("a.png"), StartsWith("\x89PNG"));
  EXPECT_THROW(WritePicture(folder / "a.gif", {figure}), InputError);
  EXPECT_THROW(WritePicture(folder / "no/folder/a.png", {figure}), WorkError);
  EXPECT_THROW(WritePicture(folder / "no/folder/a.svg", {figure}), WorkError);
}

}  // namespace
}  // namespace flextip::report
