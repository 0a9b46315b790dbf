// A collar's sizes against what can be measured on a prism, and refusals.
#include "targets/collar/design.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "core/error.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

using testing::HasSubstr;

std::string Refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return "not refused";
}

/// Returns the corners of a tag's plate, its white rim included, in E.
std::vector<Eigen::Vector3d> PlateCorners(const CollarDesign& d, const CollarTag& tag) {
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      corners.push_back(tag.T_EG * (d.plate_m * Eigen::Vector3d(x, y, 0)));
    }
  }
  return corners;
}

TEST(CollarDesign, DefaultPassesATwelveMillimetrePort) {
  const CollarDesign d = DesignCollar({});
  EXPECT_LE(d.outer_m, 0.012);
  EXPECT_NEAR(d.tag_size_m, 0.0048, 1e-12);  // 10 of 8 cells on a face of 6 mm
  EXPECT_NEAR(d.plate_m, 0.006, 1e-12);
  EXPECT_EQ(d.collar.family, "tag36h11");
  EXPECT_EQ(d.collar.tags.size(), 6u);
  EXPECT_GE(0.5 * (d.across_m - d.bore_m), kLeastWall_m);
}

class AllFaces : public testing::TestWithParam<int> {};

// No plate reaches past a neighbour's plane, and all lie in a circle of the stated diameter.
TEST_P(AllFaces, PlatesFitBetweenTheirNeighbours) {
  for (const char* family : {"tag36h11", "tag16h5", "tagStandard41h12", "tagCircle21h7"}) {
    const CollarDesign d = DesignCollar({.faces = GetParam(), .family = family});
    for (const CollarTag& tag : d.collar.tags) {
      EXPECT_NEAR(tag.T_EG.R.determinant(), 1.0, 1e-12);
      EXPECT_NEAR(tag.T_EG.p.x(), -0.03, 1e-12);
      for (const Eigen::Vector3d& corner : PlateCorners(d, tag)) {
        EXPECT_LE(2.0 * corner.tail<2>().norm(), d.outer_m + 1e-9) << family;
        for (const CollarTag& other : d.collar.tags) {
          const Eigen::Vector3d out = -other.T_EG.R.col(2);
          EXPECT_LE(out.dot(corner - other.T_EG.p), 1e-9) << family;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Prisms, AllFaces, testing::Values(3, 4, 5, 6, 8, 12));

TEST(CollarDesign, TagsReadAsTheyAreGlued) {
  const CollarDesign d = DesignCollar({.ids = {7, 3, 5, 11, 2, 9}});
  for (std::size_t i = 0; i < 6; ++i) {
    const Pose& T_EG = d.collar.tags[i].T_EG;
    EXPECT_EQ(d.collar.tags[i].id, (std::vector{7, 3, 5, 11, 2, 9})[i]);
    EXPECT_TRUE(T_EG.R.col(0).isApprox(Eigen::Vector3d::UnitX()));  // read toward the tip
    const Eigen::Vector3d out(0, T_EG.p.y(), T_EG.p.z());           // z into the shaft
    EXPECT_NEAR(T_EG.R.col(2).dot(out.normalized()), -1.0, 1e-12);
    EXPECT_NEAR(out.norm(), 0.5 * d.across_m + d.wishes.paper_m, 1e-12);
  }
}

TEST(CollarDesign, SmallestCollarForATagAndLargestTagForADiameter) {
  const CollarDesign tag = DesignCollar({.tag_size_m = 0.005});
  EXPECT_NEAR(tag.face_m, tag.plate_m, 1e-12);
  EXPECT_NEAR(tag.outer_m, 2 * 0.00625, 1e-12);  // a hexagon is as wide as two of its sides
  const CollarDesign outer = DesignCollar({.outer_m = 0.015});
  EXPECT_NEAR(outer.tag_size_m, 0.006, 1e-12);
  const CollarDesign thick = DesignCollar({.shaft_diameter_m = 0.01, .tag_size_m = 0.002});
  EXPECT_NEAR(0.5 * (thick.across_m - thick.bore_m), kLeastWall_m, 1e-12);
}

TEST(CollarDesign, RefusesWhatDoesNotFit) {
  const auto refusal = [](const CollarWishes& w) { return Refusal([&] { DesignCollar(w); }); };
  EXPECT_THAT(refusal({.tag_size_m = 0.006, .outer_m = 0.012}),
              testing::AllOf(HasSubstr("7.50 mm wide"), HasSubstr("6.00 mm wide"),
                             HasSubstr("a tag of 4.8 mm"), HasSubstr("allow 15.00 mm")));
  EXPECT_THAT(refusal({.shaft_diameter_m = 0.01, .outer_m = 0.012}),
              HasSubstr("over their corners"));
  EXPECT_THAT(refusal({.shaft_diameter_m = 5}), HasSubstr("a shaft of 5000 mm"));
  EXPECT_THAT(refusal({.faces = 2}), HasSubstr("2 faces"));
  EXPECT_THAT(refusal({.ids = {1, 2}}), HasSubstr("2 ids for 6 faces"));
  EXPECT_THAT(refusal({.ids = {1, 2, 3, 4, 5, 1}}), HasSubstr("twice"));
  EXPECT_THAT(refusal({.ids = {1, 2, 3, 4, 5, 600}}), HasSubstr("600"));
  EXPECT_THAT(refusal({.family = "tag99"}), HasSubstr("tag99"));
  EXPECT_THAT(refusal({.from_tip_m = 0.002}), HasSubstr("past the tip"));
  EXPECT_THAT(refusal({.tag_size_m = NAN}), HasSubstr("a tag of nan mm"));
}

}  // namespace
}  // namespace flextip
