// Boundaries of the workspaces against a test of points.
#include "workspace/outline.h"

#include <gtest/gtest.h>

#include "workspace/true_shaft.h"

namespace flextip {
namespace {

using Eigen::Vector2d;

/// By the number of crossings of a ray.
bool IsInside(const std::vector<Vector2d>& outline, const Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const Vector2d &a = outline[i - 1], &b = outline[i];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    const double x = a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (x > p.x()) inside = !inside;
  }
  return inside;
}

double DistanceTo(const std::vector<Vector2d>& outline, const Vector2d& p) {
  double least = 1e9;
  for (const auto& q : outline) least = std::min(least, (q - p).norm());
  return least;
}

TEST(Outline, OfTheWristHoldsWhatTheArmCanReach) {
  const PlanarArm arm;
  const auto outline = WristOutline(arm, 0.001);
  for (double y = -0.4; y < 0.7; y += 0.007) {
    for (double z = -0.7; z < 0.4; z += 0.007) {
      if (DistanceTo(outline, {z, y}) < 0.002) continue;
      EXPECT_EQ(IsInside(outline, {z, y}), arm.Solve({z, y}).status == ArmStatus::kOk)
          << z << " " << y;
    }
  }
}

TEST(Outline, OfTheTipHoldsWhereTheTipCanBe) {
  const PlanarInstrument instrument;
  const auto outline = TipOutline(instrument, 0.001);
  TrueShaft<2> shaft(instrument, std::nullopt);
  for (double y = -0.4; y < 0.4; y += 0.007) {
    for (double z = -0.2; z < 0.5; z += 0.007) {
      const Vector2d p(z, y);
      if (DistanceTo(outline, p) < 0.003) continue;
      EXPECT_EQ(IsInside(outline, p), shaft.AtTip(p).has_value()) << z << " " << y;
    }
  }
}

TEST(Outline, WristPositionsAreSplitByTheShaftsReach) {
  const PlanarInstrument instrument;
  const auto found = FindWristPositions(instrument, 0.01);
  EXPECT_GT(found.reaching.size(), 100U);
  EXPECT_GT(found.not_reaching.size(), 100U);
  for (const auto& p : found.reaching) EXPECT_TRUE(instrument.Tip(p));
  for (const auto& p : found.not_reaching) EXPECT_GE((p - instrument.p_port).norm(), 0.32);
}

}  // namespace
}  // namespace flextip
