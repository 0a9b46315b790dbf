// The largest errors that a part of the workspace stands, against brute force.
#include "workspace/tolerance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace flextip {
namespace {

const MapSetup<2> kSetup{.truth = {}};

ToleranceQuestion<2> Question(Measure measure, double limit) {
  return {.bounds = {.half_width = {.port_m = {0.001, 0.001}}, .shape = BoundShape::kEllipsoid},
          .measure = measure,
          .limit = limit,
          .part_min = {0.28, -0.06},
          .part_max = {0.40, 0.06}};
}

/// Worst value of the measure in the part over ports on a circle.
double WorstOnCircle(const WorkspaceMap<2>& map, const ToleranceQuestion<2>& question,
                     double radius_m) {
  double worst = 0.0;
  for (const auto& at : map.points) {
    if (!at.state) continue;
    if ((at.p_tip.array() < question.part_min.array()).any() ||
        (at.p_tip.array() > question.part_max.array()).any())
      continue;
    for (int i = 0; i < 720; ++i) {
      const double angle = i * M_PI / 360.0;
      const BeliefError<2> error{.port_m =
                                     radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))};
      const auto belief = Believe(kSetup.truth, error, at.state->theta);
      const double value = question.measure == Measure::kNorm
                               ? FindStepError(at.state->J, belief->J_hat, 1.0).norm
                               : FindLargestAngle(at.state->J, belief->J_hat).phi_max_rad;
      worst = std::max(worst, value);
    }
  }
  return worst;
}

TEST(Tolerance, IsWhereBruteForcePassesTheLimit) {
  const auto map = ComputeMap(kSetup, {}, 0.01);
  for (const auto& question :
       {Question(Measure::kNorm, 1.0), Question(Measure::kAngle, M_PI / 6.0)}) {
    const auto tolerance = FindTolerance(kSetup, map, question);
    ASSERT_EQ(tolerance.status, ToleranceStatus::kOk);
    const double radius = 0.001 * tolerance.scale;
    EXPECT_GT(radius, 0.001);
    EXPECT_LT(WorstOnCircle(map, question, radius), question.limit);
    EXPECT_GT(WorstOnCircle(map, question, radius * 1.002), question.limit);
    EXPECT_NEAR(tolerance.first.value, question.limit, 2e-3 * question.limit);
    EXPECT_NEAR(tolerance.first.error.port_m.norm(), radius, 1e-3 * radius);
    EXPECT_GE(map.points[tolerance.point].p_tip.x(), 0.28);
  }
}

TEST(Tolerance, SaysWhyThereIsNone) {
  const auto map = ComputeMap(kSetup, {}, 0.02);
  auto question = Question(Measure::kNorm, 1.0);
  question.part_min = {1.0, 1.0};
  question.part_max = {2.0, 2.0};
  EXPECT_EQ(FindTolerance(kSetup, map, question).status, ToleranceStatus::kEmptyPart);

  MapSetup<2> wrong = kSetup;
  wrong.error.port_m = {0.05, 0.05};
  EXPECT_EQ(FindTolerance(wrong, map, Question(Measure::kNorm, 0.1)).status,
            ToleranceStatus::kFailsAlready);

  EXPECT_EQ(FindTolerance(kSetup, map, Question(Measure::kAngle, 3.2)).status,
            ToleranceStatus::kNoLimit);  // no angle is larger than pi
}

}  // namespace
}  // namespace flextip
