// The printed strip, rasterised by another program and read by the detector: the ids, sizes and
// order of the tags, and the ruler.
#include "targets/collar/print.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "core/error.h"
#include "tests/targets/rasterise.h"
#include "vision/tags/detector.h"

namespace flextip {
namespace {

constexpr double kPxPerMm = 30.0;

double Side_px(const TagDetection& tag) {
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    sum += (tag.corners_px[k] - tag.corners_px[(k + 1) % 4]).norm() / 4;
  }
  return sum;
}

Eigen::Vector2d Middle(const TagDetection& tag) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& corner : tag.corners_px) sum += corner / 4;
  return sum;
}

struct Case {
  const char* family;
  int faces;
};
class PrintedStrip : public testing::TestWithParam<Case> {};

TEST_P(PrintedStrip, IsReadByTheDetector) {
  if (!CanRasterise()) GTEST_SKIP() << "no pdftoppm (Debian: poppler-utils)";
  CollarWishes wishes{.faces = GetParam().faces, .family = GetParam().family};
  for (int i = 0; i < wishes.faces; ++i) wishes.ids.push_back(20 - 2 * i);
  const CollarDesign d = DesignCollar(wishes);
  const auto pdf = Scratch("print.pdf");
  PrintCollar(d, PaperOf("a4"), pdf);
  const double width = 1e3 * d.length_m, height = 1e3 * d.strip_face_m * (wishes.faces + 1);
  const Image page =
      Rasterise(pdf, kPxPerMm, {Eigen::Vector2d(28, 86), Eigen::Vector2d(34 + width, 90 + height)});
  auto tags = TagDetector({.family = d.collar.family, .max_hamming = 0}).Detect(page);
  ASSERT_EQ(tags.size(), d.collar.tags.size());
  std::sort(tags.begin(), tags.end(),
            [](const auto& a, const auto& b) { return Middle(a).y() < Middle(b).y(); });
  for (std::size_t i = 0; i < tags.size(); ++i) {
    EXPECT_EQ(tags[i].id, d.collar.tags[i].id);  // from above to below
    EXPECT_NEAR(Side_px(tags[i]) / kPxPerMm, 1e3 * d.tag_size_m, 0.015);
    const Eigen::Vector2d right = tags[i].corners_px[1] - tags[i].corners_px[0];
    EXPECT_NEAR(right.normalized().x(), 1.0, 1e-3);  // upright: x to the right
    EXPECT_LT(tags[i].corners_px[3].y(), tags[i].corners_px[0].y());
    if (i == 0) continue;
    EXPECT_NEAR((Middle(tags[i]) - Middle(tags[i - 1])).y() / kPxPerMm, 1e3 * d.strip_face_m, 0.01);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, PrintedStrip,
                         testing::Values(Case{"tag36h11", 6}, Case{"tag25h9", 5},
                                         Case{"tag16h5", 6}, Case{"tagStandard41h12", 4},
                                         Case{"tagCircle21h7", 8}, Case{"tagStandard52h13", 3}));

/// The places of dark pixels' runs along a row of the page, mm: their middles.
std::vector<double> DarkRuns(const Image& page, int row) {
  std::vector<double> runs;
  for (int x = 0; x < page.width_px; ++x) {
    const int from = x;
    while (x < page.width_px && page.Row(row)[x] < 128) ++x;
    if (x > from) runs.push_back(0.5 * (from + x) / kPxPerMm);
  }
  return runs;
}

TEST(PrintedPage, HasARulerOfAHundredMillimetres) {
  if (!CanRasterise()) GTEST_SKIP() << "no pdftoppm (Debian: poppler-utils)";
  const auto pdf = Scratch("print.pdf");
  PrintCollar(DesignCollar({}), PaperOf("a4"), pdf);
  // A millimetre below the line all ticks cross; at 3.5 mm those of every centimetre.
  const Image page = Rasterise(pdf, kPxPerMm, {Eigen::Vector2d(25, 66), Eigen::Vector2d(135, 71)});
  EXPECT_EQ(DarkRuns(page, static_cast<int>(1.2 * kPxPerMm)).size(), 101u);
  const auto tens = DarkRuns(page, static_cast<int>(3.5 * kPxPerMm));
  ASSERT_EQ(tens.size(), 11u);
  EXPECT_NEAR(tens.back() - tens.front(), 100.0, 0.04);
}

TEST(PrintedPage, RefusesAStripThatIsLongerThanThePaper) {
  const CollarDesign large =
      DesignCollar({.shaft_diameter_m = 0.05, .tag_size_m = 0.05, .from_tip_m = 0.1});
  EXPECT_THROW(PrintCollar(large, PaperOf("a4"), Scratch("print.pdf")), InputError);
  EXPECT_THROW(PaperOf("a9"), InputError);
}

}  // namespace
}  // namespace flextip
