// All fixtures of a run together.
#include "control/fixtures.h"

#include <gtest/gtest.h>

#include <limits>

#include "allocation_counter.h"

namespace flextip {
namespace {

using Eigen::Vector3d;

const ForbiddenHalfSpace kFloor{{0, 0, 0}, Vector3d::UnitZ()};
const ForbiddenHalfSpace kWall{{0, 0, 0}, Vector3d(1, 0, 1).normalized()};

TEST(Fixtures, NoneLeaveTheGoalAlone) {
  const FixturesOutput output = Constrain(Fixtures(), {1, 2, 3}, 0.1);
  EXPECT_EQ(output.status, FixtureStatus::kFree);
  EXPECT_EQ(output.p_RE_desired, Vector3d(1, 2, 3));
}

TEST(Fixtures, TheMarginGrowsWithTheTipsDeviation) {
  const Fixtures fixtures{{kFloor}, 0.001, 3.0};
  const FixturesOutput output = Constrain(fixtures, {0.1, 0.2, -0.05}, 0.002);
  EXPECT_EQ(output.status, FixtureStatus::kMoved);
  EXPECT_LT((output.p_RE_desired - Vector3d(0.1, 0.2, 0.007)).norm(), 1e-12);
  EXPECT_EQ(Constrain(fixtures, {0.1, 0.2, 0.008}, 0.002).status, FixtureStatus::kFree);
}

// One region pushes the goal into the other: it must end outside of both.
TEST(Fixtures, RegionsAreLeftTogether) {
  const Fixtures fixtures{{kFloor, kWall}, 0.0, 0.0};
  const Vector3d p = Constrain(fixtures, {-0.05, 0, -0.01}, 0.0).p_RE_desired;
  EXPECT_GT(p.z(), -1e-6);
  EXPECT_GT(kWall.normal.dot(p), -1e-6);
}

TEST(Fixtures, SaysWhereThereIsNoPlaceLeft) {
  const ForbiddenHalfSpace ceiling{{0, 0, -0.01}, -Vector3d::UnitZ()};
  EXPECT_EQ(Constrain(Fixtures{{kFloor, ceiling}, 0.0, 0.0}, {0, 0, -0.005}, 0.0).status,
            FixtureStatus::kNotClear);
}

// A guiding path may lead into a region; the region has the last word, wherever it is listed.
TEST(Fixtures, RegionsComeAfterGuidance) {
  const PathGuidance path({{0, 0, -0.02}, {0.1, 0, -0.02}});
  for (const std::vector<Fixture>& list : {std::vector<Fixture>{path, kFloor}, {kFloor, path}}) {
    const FixturesOutput output = Constrain(Fixtures{list, 0.0, 0.0}, {0.05, 0.01, 0.01}, 0.0);
    EXPECT_EQ(output.status, FixtureStatus::kMoved);
    EXPECT_LT((output.p_RE_desired - Vector3d(0.05, 0, 0)).norm(), 1e-12);
  }
}

TEST(Fixtures, RefuseWhatIsNotFinite) {
  const Vector3d p(0, std::numeric_limits<double>::quiet_NaN(), 0);
  EXPECT_EQ(Constrain(Fixtures{{kFloor}, 0.0, 0.0}, p, 0.0).status, FixtureStatus::kBadInput);
}

TEST(Fixtures, AllocateNothing) {
  const Fixtures fixtures{{PathGuidance({{0, 0, 0}, {1, 0, 0}}, 0.5), kFloor, kWall}, 0.001, 1.0};
  const long before = AllocationCount();
  const FixturesOutput output = Constrain(fixtures, {-0.3, 0.2, -0.1}, 0.001);
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_NE(output.status, FixtureStatus::kBadInput);
}

}  // namespace
}  // namespace flextip
